"""Assertions of which one is enough; answers with several scenarios, and comparisons of behaviors."""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import AfterValidator, ValidationInfo, model_validator

from irsim_evals.grader.artefact import scenarios_in
from irsim_evals.grader.matching import Counted, Match, Quantity, matches
from irsim_evals.grader.predicates._base import AnswerPredicate, EpisodePredicate, Observation, register, registered
from irsim_evals.grader.predicates.reply import occurs
from irsim_evals.grader.relations import related
from irsim_evals.grader.runs_of_answers import Runs, runs_of
from irsim_evals.grader.words import BehaviorName, Regex, unknown

if TYPE_CHECKING:
    from irsim_evals.grader.episode import GradedEpisode
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import GradedScene

_WORLD = ["scene", "seeds"]
"""Subjects of predicates about the world."""
_SEED = 0
"""Seed of the worlds that are looked at."""
_ROUNDING = 1
"""Steps by which a horizon that a program counts in seconds may be off."""
_SEEDS = (0, 1)
"""Seeds of the worlds that are compared."""


def _known(item: dict[str, Any], info: ValidationInfo, subjects: Collection[str]) -> dict[str, Any]:
    known = {name: one for name, one in registered().items() if one.subject in subjects}
    for name in [name for name in item or [""] if name not in known]:
        raise unknown("predicate", name, list(known))
    return {name: known[name].model_validate(value, context=info.context) for name, value in item.items()}


def _look(predicate: Any, material: Material, scene: GradedScene, episode: GradedEpisode | None = None) -> Observation:
    """The observation of a predicate of its subject."""
    subjects: dict[str, list[Any]] = {"scene": [scene], "episode": [episode]}
    try:
        seen: Observation = related(predicate, material, scene).observe(material, *subjects.get(predicate.subject, []))
    except LookupError as error:
        return Observation(False, predicate.name, str(error))
    return seen


@register("any")
class AnyOf(EpisodePredicate):
    """At least one of some alternatives holds, about the world at its start, the episode or the answer: a list of
    mappings of predicates, and all predicates of a mapping hold."""

    at_start = True

    ways: list[Annotated[dict[str, Any], AfterValidator(partial(_known, subjects=[*_WORLD, "episode", "answer"]))]]
    """The alternatives; the list itself is the value of ``any``."""

    @model_validator(mode="before")
    @classmethod
    def _listed(cls, value: Any) -> Any:
        return value if isinstance(value, dict) else {"ways": value}

    def _has(self, name: str) -> bool:
        return any(getattr(one, name, False) for way in self.ways for one in way.values())

    looks = property(lambda self: self._has("looks"))
    exact = property(lambda self: self._has("exact"))

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Try them in turn."""
        tried = [[_look(one, material, episode.scene, episode) for one in way.values()] for way in self.ways]
        failed = [[look for look in looks if not look.passed] for looks in tried]
        chosen = [bad[0] if bad else looks[0] for bad, looks in zip(failed, tried, strict=True)]
        words = " or ".join(look.expected for look in chosen), "; ".join(look.observed for look in chosen)
        return Observation(not all(failed), *words, marks=[mark for look in chosen for mark in look.marks])


@register("every_scenario", "facts")
class EveryScenario(AnswerPredicate):
    """Every scenario file that the agent left is valid and fulfils some assertions about its world."""

    number: Match = Match(ge=1)
    """Accepted numbers of scenario files."""
    that: list[Annotated[dict[str, Any], AfterValidator(partial(_known, subjects=_WORLD))]]
    """Assertions about the world: each is a mapping of predicates."""

    def observe(self, material: Material) -> Observation:
        """Open each of them."""
        names = scenario_names(material)
        expected = f"scenarios: {self.number.words()}, each as wanted"
        if not matches(self.number, len(names), "count"):
            return Observation(False, expected, f"{len(names)}: {', '.join(names[:6])}")
        for name in names:
            try:
                one = material.other(name)
            except LookupError as error:
                return Observation(False, expected, str(error), name)
            for predicate in [said for item in self.that for said in item.values()]:
                observation = _look(predicate, one, one.scene(_SEED))
                if not observation.passed:
                    words = f"{name}: {observation.expected}", f"{name}: {observation.observed}"
                    return Observation(False, *words, observation.yaml_path, _SEED, observation.marks)
        return Observation(True, expected, f"{len(names)} scenarios")


def scenario_names(material: Material) -> list[str]:
    """Names of the scenario files that the agent left."""
    return sorted(name for name in scenarios_in(material.answer.files) if name not in material.given)


@register("comparison", "relations")
class Comparison(AnswerPredicate):
    """Behaviors are compared fairly: with the same scenarios but for the behavior, the same seeds, the same horizon."""

    robots: list[Counted]
    """Numbers of robots; there is at least one scenario for each."""
    behaviors: list[BehaviorName]
    """Behaviors that are compared: each has a file of its own for each number of robots, or what runs the scenarios
    sets it."""
    episodes: Counted
    """Number of episodes of each behavior and number of robots."""
    steps: Counted
    """Horizon in steps."""
    metrics: dict[str, list[Regex]]
    """Name → regular expressions, one of which occurs in what runs the scenarios or in what it prints."""
    seconds: Quantity = 20.0
    """How long the rehearsal of each program may take [s]."""

    def observe(self, material: Material) -> Observation:
        """Compare the files, and look at the episodes that are run."""
        expected = (
            f"{', '.join(self.behaviors)} with {', '.join(map(str, self.robots))} robots, {self.episodes} episodes of "
            f"{self.steps} steps each, and {', '.join(self.metrics)}"
        )
        groups: dict[int, dict[str, Material]] = {}
        problem = self._files(material, groups) or self._runs(material, groups)
        return Observation(not problem, expected, problem or "so it is")

    def _files(self, material: Material, groups: dict[int, dict[str, Material]]) -> str:
        """The first problem of the scenarios, which are sorted by their numbers of robots; empty without one."""
        for name in scenario_names(material):
            try:
                one = material.other(name)
            except LookupError as error:
                return str(error)
            groups.setdefault(len(one.scene(0).robots), {})[name] = one
        for number in self.robots:
            files = groups.get(number, {})
            if not files:
                return f"no scenario with {number} robots, but with {', '.join(map(str, sorted(groups))) or 'none'}"
            for a, b in itertools.pairwise(files):
                odd = _differing(_facts(files[a], layout=True), _facts(files[b], layout=True))
                if odd:
                    return f"{a} and {b} differ in {odd}, too"
        firsts = [next(iter(groups[number].items())) for number in self.robots]
        for (a, one), (b, other) in itertools.pairwise(firsts):
            odd = _differing(_facts(one), _facts(other))
            if odd:
                return f"{a} and {b} differ in {odd}, too"
        return ""

    def _runs(self, material: Material, groups: dict[int, dict[str, Material]]) -> str:
        """The first problem of the episodes that programs start, commands plan or, without either, the reply tells."""
        runs = runs_of(material, set(self.behaviors), self.seconds)
        if isinstance(runs, str):
            return runs
        problem = self._started(runs, groups) if runs.started else self._told(runs.words, groups)
        if problem:
            return problem
        missing = next((name for name, ways in self.metrics.items() if not occurs(ways, runs.words)), "")
        return f"nothing reports the rate of {missing}" if missing else ""

    def _started(self, runs: Runs, groups: dict[int, dict[str, Material]]) -> str:
        """The first problem of the episodes; empty without one."""
        numbers = {name: number for number, files in groups.items() for name in files}
        seeds: dict[tuple[int, str], list[int]] = {}
        for one in runs.started:
            if one.file not in numbers:
                return f"{runs.by} runs {one.file or 'a text'}, which is not a scenario of the answer"
            steps = one.steps if one.steps is not None else _limit(groups[numbers[one.file]][one.file])
            if steps is None or abs(steps - self.steps) > _ROUNDING:
                return f"{runs.by} gives {one.file} {'no horizon' if steps is None else f'{steps} steps'}"
            for behavior in one.behaviors:
                seeds.setdefault((numbers[one.file], behavior), []).append(one.seed)
        common = max(map(set, seeds.values()), key=len)
        for number, behavior in itertools.product(self.robots, self.behaviors):
            own = seeds.get((number, behavior), [])
            if not own:
                return f"nothing runs {behavior} with {number} robots"
            if len(own) != self.episodes:
                return f"{runs.by} runs {behavior} with {number} robots in {len(own)} episodes"
            if set(own) != common or len(common) < len(own):
                return f"{runs.by} gives {behavior} with {number} robots other seeds, or seeds twice"
        return ""

    def _told(self, words: str, groups: dict[int, dict[str, Material]]) -> str:
        """The first gap in the words about a comparison that nothing in the answer runs; empty without one."""
        for number, behavior in itertools.product(self.robots, self.behaviors):
            own = any({body.behavior for body in one.scene(0).robots} == {behavior} for one in groups[number].values())
            if not own and not re.search(rf"\b{behavior}\b", words, re.IGNORECASE):
                return f"nothing runs {behavior} with {number} robots"
        limits = {_limit(one) for files in groups.values() for one in files.values()}
        if limits != {self.steps} and not re.search(rf"(?<![\d.]){self.steps}\W{{0,3}}(?:time)?\W?steps?\b", words):
            return f"no horizon of {self.steps} steps; by the scenarios {', '.join(map(str, limits))}"
        many = rf"(?<![\d.]){self.episodes}\b\W{{0,3}}(?:\w+\W+){{0,2}}?(?:seed|episode|run|layout|trial)"
        many += rf"|\b(?:seed|episode|run)s?\W{{1,4}}{self.episodes}\b"
        return "" if re.search(many, words, re.IGNORECASE) else f"nothing says that there are {self.episodes} episodes"


def _limit(one: Material) -> int | None:
    world = one.scene(_SEEDS[0]).world
    return None if world.time_limit is None else round(world.time_limit / world.step_time)


def _facts(one: Material, *, layout: bool = False) -> dict[str, Any]:
    """Facts that must be equal in scenarios that are compared.

    Args:
        one: The scenario.
        layout: Whether starts and goals count, and how many robots there are.
    """
    scene = one.scene(_SEEDS[0])
    world = scene.world
    keys = ("kinematics", "shape", "extent", "limits", "sensors")
    robots = [
        [*(getattr(body, key) for key in keys), body.record.goal_threshold, body.record.arrive_mode]
        for body in scene.robots
    ]
    facts: dict[str, Any] = {
        "the size of the world": scene.bounds,
        "the time of a step": [world.step_time, world.sample_time],
        "the time limit": world.time_limit,
        "the modes of the world": [world.collision_mode, world.step_mode, world.control_mode, world.boundary],
        "the map": str(world.obstacle_map),
        "the obstacles": [] if scene.env.scenario.placements else [body.footprint.wkt for body in scene.solids],
        "drive, shape, limits or sensors of a robot": sorted({repr(robot) for robot in robots}),
    }
    if layout:
        facts["starts and goals"] = [
            [body.pose[:2], body.goals] for seed in _SEEDS for body in one.scene(seed).bodies if not body.static
        ]
    return facts


def _differing(a: dict[str, Any], b: dict[str, Any]) -> str:
    """The first fact that differs; empty if all agree."""
    return next((name for name in a if a[name] != b[name]), "")
