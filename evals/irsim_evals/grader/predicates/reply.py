"""Words, numbers and claims of the reply, and whether the world and its episodes agree."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pydantic import model_validator

from irsim.common.arguments import is_number
from irsim.options.registry import BEHAVIORS, KINEMATICS
from irsim_evals.grader.episode import run_episode
from irsim_evals.grader.matching import UNITS, Counted, Match, Quantity, Seeds, matches, quantity, show
from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register
from irsim_evals.grader.predicates.encounters import closest
from irsim_evals.grader.properties import PropertyName, value_of
from irsim_evals.grader.selection import Selection
from irsim_evals.grader.words import Regex

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import GradedScene

__all__ = ["Claim", "claims", "occurs"]

_NUMBER_WORDS = [
    "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve",
    "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen", "twenty",
]  # fmt: skip
_COUNT = rf"(\d+|{'|'.join(_NUMBER_WORDS)})"
_NUMBER = r"(\d+(?:\.\d+)?)"
_SIZE = re.compile(rf"{_NUMBER}\s*(?:m\s*)?(?:x|×|by)\s*{_NUMBER}\s*(?:m\b|met)", re.IGNORECASE)
_ROBOTS = re.compile(rf"\b{_COUNT}\s+(?:\w+\s+)?robots?\b", re.IGNORECASE)
_OTHERS = re.compile(
    rf"\b{_COUNT}\s+(?:\w+[\s-]+)?(people|pedestrians?|persons?|humans?|walkers?|obstacles?|movers?|boxes|pillars?|"
    r"posts?|agents?|bystanders?|discs?)\b",
    re.IGNORECASE,
)
_MEASURE = re.compile(
    rf"\b(radius|radii|speed|range|threshold|length|width|diameter)\b[^.\d\n]{{0,24}}{_NUMBER}\s*(m/s|km/h|cm|mm|m)\b",
    re.IGNORECASE,
)
_BEFORE = re.compile(rf"{_NUMBER}\s*(m/s|km/h|cm|mm|m)\s+(radius|range|speed|diameter)\b", re.IGNORECASE)
_LATER = r"[^.!?;]*(?:\b(?:will|would|can|could|once)\b|'ll\b)(?:[^.!?;]|\.(?=\w))*"
"""A sentence about what is not done yet."""
_MAX_QUOTED = 120
"""Number of characters of a reply that an observation quotes."""
_STATED = re.compile(r"(?<![\w.,])(\d+(?:[.,]\d+)?)\s*(km/h|m/s|cm|mm|m|s(?:e[cgk]\w*)?|°|deg|rad)?(?![\w])")
_AROUND = 100
"""Number of characters before and behind a about in which its value is looked for."""
_UNITS = {"arrival": ("s",), "separation": ("m", "cm", "mm"), "path": ("m", "cm", "mm")}
"""Measure of an episode → units of its numbers; the others are numbers of bodies."""
_ROUNDED = 0.2
"""Greatest relative deviation of a rounded number."""


@dataclass(frozen=True)
class Claim:
    """One claim.

    Attributes:
        text: As the reply has it.
        holds: Whether the world agrees; None where that cannot be told.
    """

    text: str
    holds: bool | None


def claims(reply: str, scene: GradedScene) -> list[Claim]:
    """The claims of a reply about sizes, numbers, measures, drives and behaviors, each at its first mention."""
    by_words: dict[str, Claim] = {}

    def add(text: str, holds: bool | None) -> None:
        by_words.setdefault(text.lower(), Claim(text, holds))

    width, height = float(scene.world.width), float(scene.world.height)
    boxes = [(body.extent if body.radius is None else (math.nan, math.nan)) for body in scene.bodies]
    for match in _SIZE.finditer(reply):
        a, b = float(match[1]), float(match[2])
        sizes = [(width, height), *boxes]
        add(match[0], any(_pair(a, b, size) for size in sizes))
    robots = len(scene.robots)
    for match in _ROBOTS.finditer(reply):
        add(match[0], _count(match[1]) == robots or _count(match[1]) in _group_sizes(scene, "robot"))
    for match in _OTHERS.finditer(reply):
        number = _count(match[1])
        movers = sum(not body.static for body in scene.bodies)
        totals = {len(scene.bodies) - robots, movers, movers - 1, len(scene.solids), *_group_sizes(scene, "obstacle")}
        totals |= _group_sizes(scene, "robot")
        add(match[0], number in totals)
    for match in [*_MEASURE.finditer(reply), *_BEFORE.finditer(reply)]:
        what, size, unit = (match[3], match[1], match[2]) if match.re is _BEFORE else match.groups()
        value = quantity(f"{size}{unit}")
        add(match[0], any(math.isclose(value, seen, rel_tol=0.02, abs_tol=1e-6) for seen in _measures(scene, what)))
    for name in (*BEHAVIORS.names(), *KINEMATICS.names()):
        if re.search(rf"\b{name}\b", reply, re.IGNORECASE):
            used = {body.behavior for body in scene.bodies} | {body.kinematics for body in scene.bodies}
            add(name, True if name in used else None)
    return list(by_words.values())


def _pair(a: float, b: float, size: tuple[float, float]) -> bool:
    return math.isclose(a, size[0], rel_tol=0.02) and math.isclose(b, size[1], rel_tol=0.02)


def _count(text: str) -> int:
    return _NUMBER_WORDS.index(text.lower()) if text.lower() in _NUMBER_WORDS else int(text)


def _group_sizes(scene: GradedScene, role: str) -> set[int]:
    """How many objects the entries of a role make."""
    sizes: dict[str, int] = {}
    for body in scene.bodies:
        if body.role == role:
            sizes[body.entry] = sizes.get(body.entry, 0) + 1
    return set(sizes.values()) | {len([s for s in sizes.values() if s == 1])}


def _measures(scene: GradedScene, what: str) -> list[float]:
    """Values of a measure in the world."""
    what = what.lower()
    bodies = scene.bodies
    if what.startswith("radi"):
        return [body.radius for body in bodies if body.radius is not None]
    if what == "diameter":
        return [2 * body.radius for body in bodies if body.radius is not None]
    if what == "speed":
        speeds = [body.ranges["forward"] for body in bodies if "forward" in body.ranges]
        options = [float(b.options[k]) for b in bodies for k in ("vmax", "vxmax", "max_speed") if b.options.get(k)]
        return speeds + options
    if what == "range":
        return [float(s["range_max"]) for body in bodies for s in body.sensors if "range_max" in s]
    if what == "threshold":
        return [body.record.goal_threshold for body in bodies]
    lengths = [value for body in bodies for value in body.extent]
    return [*lengths, float(scene.world.width), float(scene.world.height)]


def occurs(patterns: Iterable[str], text: str) -> bool:
    """Whether one of some regular expressions occurs in a text, ignoring case."""
    return any(re.search(pattern, text, re.IGNORECASE) for pattern in patterns)


@register("says")
class Says(AnswerPredicate):
    """Words in the reply, as regular expressions that ignore case and line breaks."""

    all_of: list[Regex] = []
    """Each of these occurs."""
    any_of: list[Regex] = []
    """At least one of these occurs."""
    none_of: list[Regex] = []
    """None of these occurs."""
    points: dict[str, list[Regex]] = {}
    """Name of a point that the reply makes → regular expressions, one of which occurs."""
    at_least: Counted | None = None
    """How many of the points it makes; default: all."""
    files_there: bool = False
    """Whether every YAML file that it names must be there, except files that it only would or will write."""
    about: str = ""
    """Its meaning in words, for the evidence."""
    turn: Counted | None = None
    """Number of the turn whose reply is meant, from 1 on; default: the last one."""

    def observe(self, material: Material) -> Observation:
        """Search the reply."""
        reply = material.answer.reply
        if self.turn is not None:
            reply = material.answer.replies[self.turn - 1] if self.turn <= len(material.answer.replies) else ""
        text = re.sub(r"\s+", " ", reply)
        missing = [pattern for pattern in self.all_of if not occurs([pattern], text)]
        unwanted = [pattern for pattern in self.none_of if occurs([pattern], text)]
        if self.files_there:
            named = re.findall(r"(?a)[\w-][\w.-]*\.ya?ml\b", re.sub(_LATER, "", text, flags=re.IGNORECASE))
            unwanted += sorted({*named} - {Path(name).name for name in material.answer.files})
        lacking = bool(self.any_of) and not occurs(self.any_of, text)
        made = [name for name, ways in self.points.items() if occurs(ways, text)]
        asked = self.all_of or self.any_of or self.points  # an empty reply holds no unwanted word
        need = len(self.points) if self.at_least is None else self.at_least
        ways = len(self.any_of) + len(self.all_of)
        expected = f"says {self.about or 'so'}, in words that the case knows ({ways} ways)"
        if unwanted:
            match = re.search(unwanted[0], text, re.IGNORECASE)
            expected += f"; it must not say {match[0]!r}" if match else ""
        if self.points:
            expected += f", and makes {need} of the points {', '.join(self.points)}; "
            expected += f"it makes {', '.join(made) or 'none'}"
        quoted = text if len(text) <= _MAX_QUOTED else text[:_MAX_QUOTED] + " …"
        passed = (bool(text) or not asked) and not (missing or unwanted or lacking) and len(made) >= need
        return Observation(passed, f"the reply {expected}", quoted or "no reply")


@register("states")
class States(AnswerPredicate):
    """The reply gives a number that the world has, or that is measured in episodes of the answer's own scenario, near
    words that name it. An empty selection fails."""

    of: Selection
    """Name of the selection; of a property the value of its first body counts."""
    property: PropertyName | None = None
    """Name of the property."""
    about: Regex
    """Regular expression for words near the value, ignoring case."""
    factors: list[Quantity] = [1.0]
    """The stated number may be the value of the property times one of these: 2 allows a diameter for a radius."""
    measure: Literal["arrival", "separation", "path", "arrived", "collided"] | None = None
    """The measure that is taken instead: when each body arrives [s]; the smallest distance to the bodies of `to`, edge
    to edge [m]; how far each one goes [m]; how many arrive or collide, in all episodes together. A sentence with the
    words of `about` and numbers of its unit, all of them wrong, fails."""
    to: Selection | None = None
    """Name of the other selection, for ``separation``."""
    seconds: Quantity = 60.0
    """Simulated time of an episode [s]; a time limit of the world ends it before."""
    seeds: Seeds = [0]
    """One episode per seed; the value in any of them is right."""
    tol: Quantity | None = None
    """Greatest deviation of the number; default: 2 %, of a measure also half of its last digit, at most 20 %."""
    besides: list[Quantity] = []
    """Numbers that may stand there, too, such as the time limit."""

    @model_validator(mode="after")
    def _one(self) -> States:
        if (self.property is None) == (self.measure is None) or (self.to is None) != (self.measure != "separation"):
            raise ValueError("give either `property` or `measure`, and `to` with separation only")
        return self

    def observe(self, material: Material) -> Observation:
        """Measure, and read the reply."""
        values = [value for seed in self.seeds for value in self._values(material, seed)]
        values = [sum(values)] if self.measure in ("arrived", "collided") else values
        shown = ", ".join(map(show, values)) or "none"
        expected = f"the reply states {self.property or self.measure} of {self.of} ({shown}) near /{self.about}/"
        reply, units = material.answer.reply, _UNITS.get(self.measure or "", ("",))
        for sentence in re.split(r"(?<=[.!?;])\s|\n", reply) if self.measure else ():
            told = [one for one in numbers_in(sentence) if one[1] in units and not self._right([one], self.besides)]
            if told and re.search(self.about, sentence, re.IGNORECASE) and not self._right(told, values):
                return Observation(False, expected, sentence.strip()[:_MAX_QUOTED])
        text = re.sub(r"\s+", " ", reply)
        spans = [mention.span() for mention in re.finditer(self.about, text, re.IGNORECASE)]
        near = [number for a, b in spans for number in numbers_in(text[max(0, a - _AROUND) : b + _AROUND])]
        seen = ", ".join(show(number) for number, *_ in near[:8]) or "no number there"
        return Observation(self._right(near, values), expected, seen)

    def _values(self, material: Material, seed: int) -> list[float]:
        """The measured values with a seed."""
        scene = material.scene(seed)
        bodies, others = (material.bodies(scene, name or self.of) for name in (self.of, self.to))
        if not bodies or not others:
            raise LookupError(f"{self.to if bodies else self.of}: no body")
        if self.property is not None:
            value = value_of(scene, bodies[0], self.property)
            return [value * factor for factor in self.factors] if is_number(value) else []
        scenario: Any = material.scenario
        episode = run_episode(scenario, seed, min(self.seconds, scene.world.time_limit or math.inf))
        if self.to is not None:
            return [min(closest(episode, a, [b]) for a in bodies for b in others if a is not b)]
        if self.measure == "path":
            return [float(np.hypot(*np.diff(episode.path(body.index), axis=0).T).sum()) for body in bodies]
        if self.measure == "collided":
            return [float(bool(episode.collisions(body.name))) for body in bodies]
        times = [time for body in bodies if (time := episode.arrival(body.name)) is not None]
        return times if self.measure == "arrival" else [float(len(times))]

    def _right(self, numbers: list[tuple[float, str, float]], values: list[float]) -> bool:
        """Whether one of some numbers is one of the values, as far as it is rounded."""
        pairs = [(a, b, half if self.measure else 0.0) for a, _, half in numbers for b in values]
        wide = [
            max(0.02 * abs(b), min(half, _ROUNDED * abs(b))) if self.tol is None else self.tol for _, b, half in pairs
        ]
        return any(abs(a - b) <= tol + 1e-9 for (a, b, _), tol in zip(pairs, wide, strict=True))


def numbers_in(text: str) -> list[tuple[float, str, float]]:
    """The numbers in a text in SI units, their units as written, and half of their last digits."""
    numbers = []
    for number, word in _STATED.findall(text):
        unit, plain = "s" if word.startswith("s") else word, number.replace(",", ".")
        one = quantity(f"1 {unit}") if all(name in UNITS for name in unit.split("/")) else 1.0
        numbers.append((float(plain) * one, unit, 0.5 * one / 10 ** len(plain.partition(".")[2])))
    return numbers


@register("assumptions")
class Assumptions(AnswerPredicate):
    """Numbers and names in the reply agree with the scenario, and do not contradict it."""

    number: Match
    """Accepted numbers of claims that hold."""

    def observe(self, material: Material) -> Observation:
        """Hold the reply against the world."""
        stated = claims(material.answer.reply, material.scene(0))
        good = [claim.text for claim in stated if claim.holds]
        bad = [claim.text for claim in stated if claim.holds is False]
        passed = matches(self.number, len(good), "count") and not bad
        observed = f"{len(good)}: {', '.join(good[:6])}" + (f"; not so: {', '.join(bad[:4])}" if bad else "")
        return Observation(passed, f"stated facts that hold: {self.number.words()}, none that do not", observed)
