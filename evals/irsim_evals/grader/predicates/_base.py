"""Base classes of predicates, their register, and how they tell what they saw."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from pydantic import BaseModel, ConfigDict, model_validator

from irsim.common.lazy import module_names
from irsim_evals.grader.body import GradedBody
from irsim_evals.grader.matching import Kind, Match, fitting, matches, show
from irsim_evals.grader.outcome import Mark, Stage
from irsim_evals.grader.selection import Selection

if TYPE_CHECKING:
    from typing_extensions import Self

    from irsim_evals.grader.episode import GradedEpisode
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import GradedScene

__all__ = [
    "AnswerPredicate", "EpisodePredicate", "Observation", "OfBodies", "Predicate", "ScenePredicate", "SeedsPredicate",
    "judged", "measured", "middle", "register", "registered", "stands_at_start", "summary", "travellers",
]  # fmt: skip

_MAX_NAMED = 4
"""Number of bodies that an observation names."""


@dataclass
class Observation:
    """An observation of a predicate.

    Attributes:
        passed: Whether the assertion holds.
        expected, observed: For people.
        yaml_path: Where the observed value comes from.
        seed: Seed of the world in which it was observed.
        marks: Places that a failed assertion is about.
    """

    passed: bool
    expected: str
    observed: str
    yaml_path: str | None = None
    seed: int | None = None
    marks: list[Mark] = field(default_factory=list)


class Predicate(BaseModel):
    """The content of an assertion; the keys of a predicate are the fields of its class."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)

    stage: ClassVar[Stage] = "facts"
    """Part of the funnel that it belongs to."""
    subject: ClassVar[Literal["scene", "seeds", "episode", "answer"]]
    """Its subject."""
    name: ClassVar[str] = ""
    """Key under which cases use it."""

    @model_validator(mode="after")
    def _of_numbers(self) -> Self:
        said = {name: value for name in self.model_fields_set if isinstance(value := getattr(self, name), Match)}
        fitting(said, {}, {}, "count")
        return self


class ScenePredicate(Predicate):
    """About the world at its start; it must hold for each seed of the case."""

    subject: ClassVar[Literal["scene", "seeds", "episode", "answer"]] = "scene"

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Look at one world."""
        raise NotImplementedError


class OfBodies(Predicate):
    """About the bodies of a selection, of which there must be some unless a predicate says otherwise."""

    of: Selection
    """Name of the selection."""

    def bodies(self, material: Material, scene: GradedScene) -> list[GradedBody]:
        """The bodies of the selection.

        Raises:
            LookupError: The selection is empty.
        """
        if not (bodies := material.bodies(scene, self.of)):
            raise LookupError(f"{self.of}: no body")
        return bodies


class SeedsPredicate(Predicate):
    """About how worlds differ from seed to seed."""

    subject: ClassVar[Literal["scene", "seeds", "episode", "answer"]] = "seeds"

    def observe(self, material: Material) -> Observation:
        """Look at several worlds."""
        raise NotImplementedError


class EpisodePredicate(Predicate):
    """About an episode; it must hold for each seed of the episode."""

    stage: ClassVar[Stage] = "behavior"
    subject: ClassVar[Literal["scene", "seeds", "episode", "answer"]] = "episode"
    at_start: ClassVar[bool] = False
    """Whether it may stand under ``assert`` of the case, too: it is then about an episode of no steps."""
    looks: ClassVar[bool] = False
    """Whether it needs the looks of sensors and fields of view."""
    exact: ClassVar[bool] = False
    """Whether it is about the episode without noise of drives and sensors."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Look at one episode."""
        raise NotImplementedError


def stands_at_start(predicate: Predicate | type[Predicate]) -> bool:
    """Whether a predicate may stand under ``assert`` of a case."""
    return predicate.subject != "episode" or bool(getattr(predicate, "at_start", False))


class AnswerPredicate(Predicate):
    """About files and words."""

    stage: ClassVar[Stage] = "reply"
    subject: ClassVar[Literal["scene", "seeds", "episode", "answer"]] = "answer"

    def observe(self, material: Material) -> Observation:
        """Look at files and words."""
        raise NotImplementedError


def travellers(predicate: OfBodies, material: Material, scene: GradedScene) -> list[GradedBody]:
    """The bodies of the selection of a predicate.

    Raises:
        LookupError: The selection is empty, or one of them has no goal.
    """
    bodies = predicate.bodies(material, scene)
    for body in bodies:
        if body.goal is None:
            raise LookupError(f"{body.name} has no goal")
    return bodies


def judged(
    expected: str,
    seen: Sequence[tuple[GradedBody, Any]],
    wrong: Sequence[tuple[GradedBody, Any]],
    key: str,
    *,
    right: str = "",
    said: str = "",
    marks: Sequence[Mark] = (),
) -> Observation:
    """The observation of bodies, of which there must be some, each of them as expected.

    Args:
        expected: The requirement, for people.
        seen: The bodies with what they are.
        wrong: The wrong ones among them.
        key: Key of an entry that decides it.
        right: The observed value if no body is wrong; default: what they are.
        said: Words before the observed value.
        marks: Places that wrong bodies are about.
    """
    if not seen:
        return Observation(False, expected, "no body")
    where = f"{wrong[0][0].entry}.{key}" if wrong else None
    observed = summary(wrong) if wrong else right or summary(seen)
    return Observation(not wrong, expected, said + observed, where, marks=list(marks))


def measured(
    said: Predicate,
    of: str,
    bodies: Sequence[GradedBody],
    kinds: Mapping[str, Kind],
    measure: Callable[[GradedBody], Mapping[str, Any]],
    key: str,
) -> Observation:
    """The observation of bodies, of which there must be some, each of them with accepted values of some measures.

    Args:
        said: The predicate, of which a field for each measure holds the accepted values, or None for any.
        of: The bodies in words.
        bodies: The bodies.
        kinds: Name of a measure → its kind.
        measure: The values of the measures of a body.
        key: Key of an entry that decides them.
    """
    asked = {name: (getattr(said, name), kind) for name, kind in kinds.items() if getattr(said, name) is not None}
    expected = f"{of}: " + ", ".join(f"{name} {match.words()}" for name, (match, _) in asked.items())
    seen, wrong = [], []
    for body in bodies:
        values = measure(body)
        seen.append((body, ", ".join(f"{name} {show(values[name])}" for name in asked)))
        if not all(matches(match, values[name], kind) for name, (match, kind) in asked.items()):
            wrong.append(seen[-1])
    return judged(expected, seen, wrong, key)


def middle(bodies: Sequence[GradedBody]) -> tuple[float, float]:
    """Mean of the positions of some bodies."""
    x, y = (sum(values) / len(bodies) for values in zip(*(body.position for body in bodies), strict=True))
    return x, y


_REGISTERED: dict[str, type[Predicate]] = {}


def register(name: str, stage: Stage | None = None) -> Callable[[type[Any]], type[Any]]:
    """Make a class the predicate of a name, in a part of the funnel that is not the usual one of its subject."""

    def add(cls: type[Any]) -> type[Any]:
        cls.name, cls.stage = name, stage or cls.stage
        _REGISTERED[name] = cls
        return cls

    return add


@functools.cache
def registered() -> dict[str, type[Predicate]]:
    """Name → predicate, in alphabetical order; imports every file of the folder."""
    package = __name__.rpartition(".")[0]
    for name in module_names(package):
        import_module(f"{package}.{name}")
    return dict(sorted(_REGISTERED.items()))


def summary(pairs: Sequence[tuple[GradedBody, Any]]) -> str:
    """Values of some bodies: ``robot_1: 0.5, robot_2: none and 3 more``."""
    shown = ", ".join(f"{body.name}: {show(value)}" for body, value in pairs[:_MAX_NAMED])
    left = len(pairs) - _MAX_NAMED
    return shown + (f" and {left} more" if left > 0 else "")
