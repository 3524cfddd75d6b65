"""Ways in worlds that are large for those who move there: by the gaps that things leave, not by cells."""

from __future__ import annotations

import math
from dataclasses import dataclass

import irsim._core as core
from irsim.scenario.checks import Context
from irsim.validation.feasibility.clearance_grid import Gap, Point
from irsim.validation.feasibility.gaps import Barriers, barriers_of
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.scenes import Scene

__all__ = ["Passages", "passages_of"]

_SLACK = 1e-6
_LEAST = 0.25
"""Where several places count as arrived, a robot this much thinner must not get to any of those that are looked at."""
_MOST_PLACES = 100


@dataclass(frozen=True)
class Passages:
    """Ways of some of those who move.

    Attributes:
        barriers: What stands in the way.
        found: (id, index of the goal) -> the narrowest gap on the widest way, None if all are wide, and whether the
            body does not get through. Ways that were not looked at are not in it.
    """

    barriers: Barriers
    found: dict[tuple[int, int], tuple[Gap | None, bool]]


def passages_of(
    context: Context, scene: Scene, movers: list[Mover], roomless: set[tuple[int, int]], *, ease: float
) -> Passages | None:
    """The ways of those for whom cells are too coarse; None where too many things stand.

    Args:
        context: The scenario.
        scene: Where everything stands.
        movers: Who.
        roomless: (robot, goal) pairs without room.
        ease: Gaps so many times as wide as a robot are wide.
    """
    open_edge = context.scenario.world.boundary == "none"
    key = f"barriers {max(m.radius for m in movers)}"
    if key not in scene.owner.kept:
        most = 2 * ease * max(m.radius for m in movers)
        scene.owner.kept[key] = barriers_of(scene.owner, most=most, open_edge=open_edge)
    barriers: Barriers | None = scene.owner.kept[key]
    if barriers is None:
        return None
    ways: list[tuple[Point, Point]] = []
    asked: list[tuple[tuple[int, int], Mover, float, range]] = []
    found: dict[tuple[int, int], tuple[Gap | None, bool]] = {}
    for mover in movers:
        if mover.record.wander:
            continue
        start = mover.centre(scene.pose[mover.record.id])
        for index, goal in enumerate(scene.goals[mover.record.id]):
            places, least = _places(scene, mover, (goal[0], goal[1]))
            if (mover.record.id, index) in roomless or len(ways) + len(places) > barriers.most_ways:
                break
            if not places:  # anywhere far around counts as arrived
                found[mover.record.id, index] = None, False
                start = (goal[0], goal[1])
                continue
            asked.append(((mover.record.id, index), mover, least, range(len(ways), len(ways) + len(places))))
            ways += [(start, place) for place in places]
            start = places[0]
    openings = barriers.openings(ways)
    for pair, mover, least, those in asked:
        widest = max((openings[k] for k in those), key=lambda opening: opening.width)
        closed = widest.width < 2 * least * (1 - _SLACK)
        narrow = closed or 2 * mover.radius <= widest.width < 2 * ease * mover.radius
        found[pair] = (Gap(widest.width, widest.place, 0.0) if narrow else None, closed)
    return Passages(barriers, found)


def _places(scene: Scene, mover: Mover, goal: Point) -> tuple[list[Point], float]:
    """Places that count as arrived, and the radius of a disc that gets to one of them wherever the body can arrive."""
    if not _hits(scene, goal, mover.radius + mover.reach):
        return [goal], mover.radius
    apart = mover.reach * math.sqrt(math.pi / _MOST_PLACES)
    least = mover.radius - apart * math.sqrt(0.5)
    if least < _LEAST * mover.radius:
        return [], 0.0
    count = math.ceil(mover.reach / apart) + 1
    around = mover.reach + apart
    steps = [(apart * i, apart * j) for i in range(-count, count + 1) for j in range(-count, count + 1)]
    steps.sort(key=lambda step: math.hypot(*step))
    places = [(goal[0] + dx, goal[1] + dy) for dx, dy in steps if math.hypot(dx, dy) <= around]
    return [place for place in places if not _hits(scene, place, least)], least


def _hits(scene: Scene, place: Point, radius: float) -> bool:
    return scene.terrain.collides([core.Circle(radius=radius, center=[0, 0])], (*place, 0.0))
