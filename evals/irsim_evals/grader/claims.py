"""What a reply claims about a scenario, found by its numbers and names, to be held against the world."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from irsim.options.registry import BEHAVIORS, KINEMATICS
from irsim_evals.grader.units import quantity

if TYPE_CHECKING:
    from irsim_evals.grader.scene import Scene

__all__ = ["Claim", "claims"]

_NUMBER_WORDS = {
    word: number
    for number, word in enumerate(
        [
            "zero",
            "one",
            "two",
            "three",
            "four",
            "five",
            "six",
            "seven",
            "eight",
            "nine",
            "ten",
            "eleven",
            "twelve",
            "thirteen",
            "fourteen",
            "fifteen",
            "sixteen",
            "seventeen",
            "eighteen",
            "nineteen",
            "twenty",
        ]
    )
}
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


@dataclass(frozen=True)
class Claim:
    """One claim.

    Attributes:
        text: As the reply has it.
        holds: Whether the world agrees; None where that cannot be told.
    """

    text: str
    holds: bool | None


def claims(reply: str, scene: Scene) -> list[Claim]:
    """The claims of a reply about sizes, numbers, measures, drives and behaviors, each at its first mention."""
    found: dict[str, Claim] = {}

    def add(text: str, holds: bool | None) -> None:
        found.setdefault(text.lower(), Claim(text, holds))

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
    return list(found.values())


def _pair(a: float, b: float, size: tuple[float, float]) -> bool:
    return math.isclose(a, size[0], rel_tol=0.02) and math.isclose(b, size[1], rel_tol=0.02)


def _count(text: str) -> int:
    return _NUMBER_WORDS[text.lower()] if text.lower() in _NUMBER_WORDS else int(text)


def _group_sizes(scene: Scene, role: str) -> set[int]:
    """How many objects the entries of a role make."""
    sizes: dict[str, int] = {}
    for body in scene.bodies:
        if body.role == role:
            sizes[body.entry] = sizes.get(body.entry, 0) + 1
    return set(sizes.values()) | {len([s for s in sizes.values() if s == 1])}


def _measures(scene: Scene, what: str) -> list[float]:
    """Values of a measure in the world."""
    what = what.lower()
    bodies = scene.bodies
    if what.startswith("radi"):
        return [body.radius for body in bodies if body.radius is not None]
    if what == "diameter":
        return [2 * body.radius for body in bodies if body.radius is not None]
    if what == "speed":
        speeds = [body.forward for body in bodies if body.forward is not None]
        options = [float(b.options[k]) for b in bodies for k in ("vmax", "vxmax", "max_speed") if b.options.get(k)]
        return speeds + options
    if what == "range":
        return [float(s["range_max"]) for body in bodies for s in body.sensors if "range_max" in s]
    if what == "threshold":
        return [body.threshold for body in bodies]
    lengths = [value for body in bodies for value in body.extent]
    return [*lengths, float(scene.world.width), float(scene.world.height)]
