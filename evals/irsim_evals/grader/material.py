"""Everything the grader has of an answer when it checks assertions: files, worlds, the reply."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from irsim.diagnostics.errors import IrsimError
from irsim.scenario.behavior_override import parse_behavior, with_behavior
from irsim.scenario.checks import KEY_CODES
from irsim.scenario.limits import Limits
from irsim.scenario.read import read
from irsim.scenario.yaml.document import Document, load_text
from irsim_evals.grader.body import GradedBody
from irsim_evals.grader.scene import GradedScene, open_scene
from irsim_evals.grader.selection import Selector, select

if TYPE_CHECKING:
    from irsim.diagnostics.diagnostic import Diagnostic
    from irsim.scenario.resolve.resolved import ResolvedScenario
    from irsim_evals.grader.artefact import Answer

__all__ = ["LIMITS", "Material", "Opened", "open_text", "with_speeds", "write_files"]

LIMITS = Limits(
    bytes=2_000_000, events=200_000, expansion=50_000, aliases=10_000, objects=5_000, robots=2_000, cells=4_000_000,
    map_bytes=16_000_000, problems=20, root=str(Path(__file__).parent / "predicates"),
)  # fmt: skip
"""Limits of a scenario. Files are read only below ``root``, where there is no map."""


@dataclass(frozen=True)
class Opened:
    """A scenario as the grader has read it.

    Attributes:
        document: The scenario as written.
        scenario: The scenario; None if it is not valid for a case.
        findings: Findings of the checker.
        errors: Findings that make it invalid for a case: errors, and keys that mean nothing.
    """

    document: Document
    scenario: ResolvedScenario | None
    findings: Sequence[Diagnostic]
    errors: Sequence[Diagnostic]

    @property
    def why(self) -> str:
        """The first of the errors, in words."""
        return "; ".join(item.message for item in self.errors[:2])


def open_text(text: str, folder: Path | None = None, name: str = "scenario.yaml") -> Opened:
    """Read a scenario within the limits of a grading.

    Args:
        text: The scenario.
        folder: Folder with the maps that it may read; default: it may read none.
        name: Path of its file in that folder.
    """
    limits, path = LIMITS, None
    if folder is not None:
        limits, path = replace(LIMITS, root=str(folder)), str(folder / name)
    document = load_text(text, path=path, limits=limits)
    if document.fatal:
        return Opened(document, None, (), document.problems)
    reading = read(document, limits=limits)
    errors = [item for item in reading.diagnostics if item.severity == "error" or item.code in KEY_CODES]
    return Opened(document, None if errors else reading.scenario, reading.diagnostics, errors)


@dataclass
class Material:
    """An answer, opened.

    Attributes:
        answer: The files and words of the agent; a scenario that stands only in its reply is a file, too.
        scenario: The scenario that the simulator has read; None if there is no scenario to read.
        selectors: Selections of the case.
        passable: Selections of bodies that others may pass through.
        late: Selections of bodies that never move and may come into the world late.
        main: Path of the file that holds the scenario.
        given: Text of each file that the folder started with.
        document: The scenario as written.
        findings: Findings of the checker about the scenario.
        given_blobs: Content of each picture that the folder started with.
        stand_ins: Content of the maps that only the user has, as the grader imagines them.
        workplace: Temporary folder of this grading.
        beside: Path of another scenario of the answer → the same for assertions about that one.
    """

    answer: Answer
    scenario: ResolvedScenario | None = None
    selectors: Mapping[str, Selector] = field(default_factory=dict)
    main: str | None = None
    given: Mapping[str, str] = field(default_factory=dict)
    document: Document | None = None
    findings: Sequence[Diagnostic] = ()
    given_blobs: Mapping[str, bytes] = field(default_factory=dict)
    stand_ins: Mapping[str, bytes] = field(default_factory=dict)
    workplace: Path | None = None
    passable: Sequence[str] = ()
    late: Sequence[str] = ()
    beside: dict[str, Material] = field(default_factory=dict, repr=False)
    _scenes: dict[int, GradedScene] = field(default_factory=dict, repr=False)

    def scene(self, seed: int) -> GradedScene:
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

    def made_solid(self, scenario: ResolvedScenario, seed: int) -> ResolvedScenario:
        """A scenario in which only those bodies are passable that may be."""
        solid = {body.index for body in self.solid_bodies(self.scene(seed)) if body.passable}
        objects = [
            replace(record, unobstructed=False) if row in solid else record
            for row, record in enumerate(scenario.objects)
        ]
        return replace(scenario, objects=objects) if solid else scenario

    @property
    def names(self) -> list[str]:
        """Paths of everything that the agent left and that was not given like this, its last message apart."""
        texts = [name for name, text in self.answer.files.items() if self.given.get(name) != text]
        blobs = [name for name, content in self.answer.blobs.items() if self.given_blobs.get(name) != content]
        return [*texts, *blobs, *self.answer.others]

    def folder(self) -> Path:
        """A folder with a copy of every file of the answer."""
        if self.workplace is None:
            raise LookupError("there is no folder to work in")
        write_files(self.workplace, self.answer.files, {**self.stand_ins, **self.answer.blobs})
        return self.workplace

    def open(self, file: str) -> Opened:
        """Read a scenario of the answer. Maps beside it are read from a copy of the answer."""
        return open_text(self.answer.files[file], self.folder() if self.answer.blobs or self.stand_ins else None, file)

    def other(self, file: str) -> Material:
        """The material for assertions about another scenario of the answer, opened once; itself for its own file.

        Raises:
            LookupError: There is no such file, it is not a valid scenario, or its world cannot be built.
        """
        if not file or (file == self.main and self.scenario is not None):
            return self
        if file not in self.beside:
            if file not in self.answer.files:
                raise LookupError(f"there is no file {file}")
            opened = self.open(file)
            if opened.scenario is None:
                raise LookupError(f"{file}: {opened.why}")
            made = replace(self, scenario=opened.scenario, document=opened.document, main=file, beside={}, _scenes={})
            try:
                made.scene(0)
            except IrsimError as error:
                raise LookupError(f"{file}: {str(error).splitlines()[0]}") from None
            self.beside[file] = made
        return self.beside[file]

    def bodies(self, scene: GradedScene, name: str) -> list[GradedBody]:
        """The bodies of a selection."""
        return select(scene, name, dict(self.selectors))

    def solid_bodies(self, scene: GradedScene) -> list[GradedBody]:
        """The bodies that others must not pass through, whether the scenario makes them passable or not."""
        may = {body.index for name in self.passable for body in self.bodies(scene, name) if body.passable}
        return [body for body in scene.bodies if body.index not in may]


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
        scenario: The scenario, perhaps with another behavior than the answer's.
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
