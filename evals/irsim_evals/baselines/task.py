"""The part of a case that a baseline sees: all that an agent gets, and nothing that only the grader knows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from irsim_evals.cases.instance import Instance

__all__ = ["Task", "task_of"]


@dataclass(frozen=True)
class Task:
    """A request.

    Attributes:
        prompt: The request to the agent.
        turns: Messages of the user after each reply.
        files: The files that the folder starts with: name → text.
    """

    prompt: str
    turns: tuple[str, ...] = ()
    files: Mapping[str, str] | None = None

    @property
    def requests(self) -> tuple[str, ...]:
        """All that the user says, one text for each turn."""
        return (self.prompt, *self.turns)


def task_of(instance: Instance) -> Task:
    """The part of an instance that an agent sees."""
    return Task(instance.prompt, tuple(instance.case.turns), dict(instance.case.files))
