"""What the grader has of an answer when it checks assertions: files, worlds, episodes, the reply."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from irsim_evals.grader.body import Body
from irsim_evals.grader.scene import Scene, open_scene
from irsim_evals.grader.selection import Selector, select

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["Material"]


@dataclass
class Material:
    """An answer, opened.

    Attributes:
        scenario: The scenario that the simulator has read; None if there is none to read.
        selectors: Selections of the case.
        texts: Text of each file that the agent left, by its path in the folder.
        main: Path of the file that holds the scenario.
        given: Text of each file that the folder started with.
        reply: Last message of the agent.
        replies: Its message after each turn.
        findings: What the checker said about the scenario.
    """

    scenario: ResolvedScenario | None
    selectors: Mapping[str, Selector]
    texts: Mapping[str, str]
    main: str | None = None
    given: Mapping[str, str] = field(default_factory=dict)
    reply: str = ""
    replies: list[str] = field(default_factory=list)
    findings: list[Any] = field(default_factory=list)
    _scenes: dict[int, Scene] = field(default_factory=dict, repr=False)

    def scene(self, seed: int) -> Scene:
        """The world with a seed at its start, built once.

        Raises:
            PlacementError: A random object found no free place.
            LookupError: There is no scenario.
        """
        if self.scenario is None:
            raise LookupError("there is no scenario that the simulator can read")
        if seed not in self._scenes:
            self._scenes[seed] = open_scene(self.scenario, seed)
        return self._scenes[seed]

    def bodies(self, scene: Scene, name: str) -> list[Body]:
        """The bodies of a selection."""
        return select(scene, name, dict(self.selectors))
