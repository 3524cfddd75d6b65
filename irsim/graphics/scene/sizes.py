"""Sizes of texts, bars and signs of the style `modern` in its layouts, for pictures and for the replay page."""

from __future__ import annotations

from dataclasses import dataclass, replace

__all__ = ["NORMAL", "PRINT", "SMALL", "STRIP", "Sizes"]


@dataclass(frozen=True)
class Sizes:
    """Sizes of one layout [u].

    Attributes:
        kind: ``normal``, ``small`` or ``print``.
        title, facts, name, foot_text: Sizes of texts.
        head, foot: Heights of the bars above and below the world.
        pad: Margin at the sides.
        grid: Least distance of two lines of the grid.
        robot: Least radius of a robot.
        person: Least radius of a person.
        trail: Width of the newest part of a trail of a robot, and of the oldest.
        goal: Least radius of a goal, and the width of its ring.
        plan: Width of a planned path.
        hit: Diameter of a hit of a lidar.
        star: Radius of the star at a contact.
        badge: Radius of a badge.
        wall: Width of walls.
    """

    kind: str
    title: float
    facts: float
    name: float
    foot_text: float
    head: float
    foot: float
    pad: float
    grid: float
    robot: float
    person: float
    trail: tuple[float, float]
    goal: tuple[float, float]
    plan: float
    hit: float
    star: float
    badge: float
    wall: float


NORMAL = Sizes("normal", 15, 12.5, 11.5, 11.5, 38, 30, 14, 44, 6.5, 6.0, (3.2, 1.5), (5, 1.6), 1.4, 2.6, 10, 7, 2.4)
SMALL = Sizes("small", 12.5, 11, 10, 10, 29, 23, 8, 30, 5.5, 5.6, (2.4, 1.3), (4, 1.3), 1.2, 2.0, 7.6, 5.4, 2.4)
PRINT = Sizes("print", 10, 9.4, 9.4, 9.4, 21, 19, 2, 30, 5.5, 5.6, (2.4, 1.3), (4, 1.3), 1.2, 2.0, 7.6, 5.4, 1.6)

STRIP = replace(SMALL, kind="strip", head=19.0, foot=3.0, pad=3.0, facts=10.0, title=10.5)
"""A moment among others: a short line above the world, and nothing below."""
