"""What the grader has of an answer when it checks assertions: files, worlds, episodes, the reply."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from irsim.scenario.behavior_override import parse_behavior, with_behavior
from irsim_evals.grader.body import Body
from irsim_evals.grader.scene import Scene, open_scene
from irsim_evals.grader.selection import Selector, select

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario
    from irsim.scenario.yaml.document import Document

__all__ = ["Material", "with_speeds", "write_files"]


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
        document: The scenario as written.
        findings: What the checker said about the scenario.
        blobs: Content of each picture or array that the agent left.
        workplace: Temporary folder of this grading.
        trusted_folder: Folder in which programs of the answer may be run; None if they must not be.
        beside: Path of another scenario of the answer → the same for assertions about that one.
    """

    scenario: ResolvedScenario | None
    selectors: Mapping[str, Selector]
    texts: Mapping[str, str]
    main: str | None = None
    given: Mapping[str, str] = field(default_factory=dict)
    reply: str = ""
    replies: list[str] = field(default_factory=list)
    document: Document | None = None
    findings: list[Any] = field(default_factory=list)
    blobs: Mapping[str, bytes] = field(default_factory=dict)
    workplace: Path | None = None
    trusted_folder: Path | None = None
    beside: dict[str, Material] = field(default_factory=dict, repr=False)
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

    def driven_by(self, behavior: str | None) -> ResolvedScenario:
        """The scenario in which the robots follow another behavior; without one as it is.

        Raises:
            IrsimError: The behavior is unknown or cannot drive these robots.
            LookupError: There is no scenario.
        """
        if self.scenario is None or self.document is None:
            raise LookupError("there is no scenario that the simulator can read")
        if behavior is None:
            return self.scenario
        return with_behavior(self.document, parse_behavior(behavior), strict=False)

    def folder(self) -> Path:
        """A folder with a copy of every file of the answer."""
        if self.workplace is None:
            raise LookupError("there is no folder to work in")
        write_files(self.workplace, self.texts, self.blobs)
        return self.workplace

    def bodies(self, scene: Scene, name: str) -> list[Body]:
        """The bodies of a selection."""
        return select(scene, name, dict(self.selectors))


def write_files(folder: Path, texts: Mapping[str, str], blobs: Mapping[str, bytes]) -> None:
    """Write files into a folder.

    Raises:
        ValueError: A name leads out of the folder.
    """
    contents = {**{name: text.encode("utf-8", errors="replace") for name, text in texts.items()}, **blobs}
    for name, content in contents.items():
        path = folder / name
        if not path.resolve().is_relative_to(folder.resolve()):
            raise ValueError(f"{name} leads out of the folder")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def with_speeds(
    scenario: ResolvedScenario, material: Material, seed: int, factors: Mapping[str, float]
) -> ResolvedScenario:
    """A scenario with other speed limits.

    Args:
        scenario: The scenario, perhaps with another behavior than that of the answer.
        material: The answer.
        seed: Seed of the world in which the bodies are selected.
        factors: Name of a selection → factor of every limit of its bodies.
    """
    for name, factor in factors.items():
        chosen = {body.index for body in material.bodies(material.scene(seed), name)}
        objects = [
            replace(record, vel_min=[v * factor for v in record.vel_min], vel_max=[v * factor for v in record.vel_max])
            if row in chosen
            else record
            for row, record in enumerate(scenario.objects)
        ]
        scenario = replace(scenario, objects=objects)
    return scenario
