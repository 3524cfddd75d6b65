"""The file of results: what each arm made of each case. ``grade``, ``run``, ``report`` and ``compare`` share it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import ConfigDict

import irsim
from irsim.common.text import escape_marks
from irsim_evals.cases.store import PUBLISHED, Instance, Store, cases_hash
from irsim_evals.grader.outcome import Record, Verdict

__all__ = ["Results", "Trial", "results_of", "trial_of", "write_results"]


class Trial(Record):
    """One attempt at one case."""

    arm: str
    """Who answered: ``null``, ``rules``, ``skill+mcp``, or the name of a folder."""
    number: int = 1
    """Number of the attempt, from 1 on."""
    model: str | None = None
    """Name of the model, where one answered."""
    title: str
    prompt: str
    """The request, later turns included."""
    category: list[str]
    level: int
    family: str
    """Cases of one family are not independent."""
    hard: str = ""
    """Why it is hard."""
    reply: str = ""
    """Last message of the agent."""
    ended: str = ""
    """Why the attempt ended before the agent was done: a limit, an error of the model's service."""
    drift: list[str] = []
    """Answers of tools that differ from the recording that was replayed."""
    verdict: Verdict

    @property
    def key(self) -> tuple[str, str]:
        """Case and instance."""
        return self.verdict.case, self.verdict.instance


class Results(Record):
    """Results of some arms on some cases; a report writes its aggregates beside them, which are not read back."""

    model_config = ConfigDict(extra="ignore")

    schema_version: int = 1
    irsim_version: str = irsim.__version__
    cases: str = ""
    """Digest of the case files that were used; results of different ones are not compared."""
    trials: list[Trial] = []


def trial_of(instance: Instance, verdict: Verdict, arm: str, **more: Any) -> Trial:
    """A trial with what the case says about it, and perhaps its ``number``, ``model``, ``reply`` and ``ended``."""
    case, prompt = instance.case, "\n\n".join(request.strip() for request in instance.requests)
    return Trial(
        arm=arm, title=case.title, prompt=prompt, category=case.category,
        level=case.level, family=case.family or case.id, hard=case.hard, verdict=verdict, **more,
    )  # fmt: skip


def results_of(trials: Iterable[Trial], store: Store = PUBLISHED) -> Results:
    """Results with the digest of the present cases."""
    return Results(cases=cases_hash(store), trials=list(trials))


def write_results(results: Results, path: Path) -> None:
    """Write a file of results."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(escape_marks(results.model_dump_json(indent=1)) + "\n", encoding="utf-8")
