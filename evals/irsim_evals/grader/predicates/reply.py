"""Words and claims of the reply, and whether the world agrees."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from irsim.options.registry import BEHAVIORS, KINEMATICS
from irsim_evals.grader.matching import UNITS, Counted, Match, Quantity, matches, quantity, show
from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register
from irsim_evals.grader.properties import PropertyName, value_of, yaml_path
from irsim_evals.grader.selection import Selection
from irsim_evals.grader.words import Regex

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import GradedScene

__all__ = ["Claim", "claims"]

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
_MAX_QUOTED = 120
"""Number of characters of a reply that an observation quotes."""
_STATED = re.compile(r"(?<![\w.,])(\d+(?:[.,]\d+)?)\s*(km/h|m/s|cm|mm|m|°|deg|rad)?(?![\w])")
_AROUND = 100
"""Number of characters before and behind a about in which its value is looked for."""


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

        def occurs(pattern: str) -> bool:
            return re.search(pattern, text, re.IGNORECASE) is not None

        missing = [pattern for pattern in self.all_of if not occurs(pattern)]
        unwanted = [pattern for pattern in self.none_of if occurs(pattern)]
        lacking = bool(self.any_of) and not any(map(occurs, self.any_of))
        made = [name for name, ways in self.points.items() if any(map(occurs, ways))]
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
    """The reply gives the value that a property of a body has in the world, near words that name the about."""

    of: Selection
    """Name of the selection; its first body counts."""
    property: PropertyName
    """Name of the property."""
    about: Regex
    """Regular expression for words near the value, ignoring case."""
    factors: list[Quantity] = [1.0]
    """The stated number may be the value times one of these: 2 allows a diameter for a radius."""

    def observe(self, material: Material) -> Observation:
        """Look for the number."""
        scene = material.scene(0)
        bodies = material.bodies(scene, self.of)
        if not bodies:
            return Observation(False, f"the reply states {self.property} of {self.of}", f"{self.of}: no body")
        value = value_of(scene, bodies[0], self.property)
        expected = f"the reply states {self.property} of {self.of} ({show(value)}) near /{self.about}/"
        where = yaml_path(bodies[0], self.property)
        if not isinstance(value, (int, float)):
            return Observation(False, expected, f"{bodies[0].name} has no {self.property}", where)
        seen = _numbers(re.sub(r"\s+", " ", material.answer.reply), self.about)
        wanted = [value * factor for factor in self.factors]
        passed = any(abs(a - b) <= 0.02 * abs(b) + 1e-9 for a in seen for b in wanted)
        observed = ", ".join(show(number) for number in seen[:8]) or "no number there"
        return Observation(passed, expected, observed, where)


def _numbers(reply: str, about: str) -> list[float]:
    """The numbers near a about in SI units."""
    numbers: list[float] = []
    for mention in re.finditer(about, reply, re.IGNORECASE):
        part = reply[max(0, mention.start() - _AROUND) : mention.end() + _AROUND]
        for number, unit in _STATED.findall(part):
            plain = number.replace(",", ".")
            known = all(name in UNITS for name in unit.split("/"))
            numbers.append(quantity(f"{plain} {unit}") if known else float(plain))
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
