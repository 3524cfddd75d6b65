"""Paths of robots that are small compared with the world, found by the gaps between obstacles instead of cells."""

from __future__ import annotations

import math
from dataclasses import dataclass

import irsim._core as core
from irsim.scenario.checks import Context
from irsim.validation.feasibility.clearance_grid import Gap, Point
from irsim.validation.feasibility.gaps import Gaps, find_gaps
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.scenes import Scene

__all__ = ["Passages", "passages_of"]

_SLACK = 1e-6
"""Share by which a gap may be narrower than a robot because of rounding."""
_MIN_RADIUS_SHARE = 0.25
"""Smallest share of a robot's radius that its disc may keep when places only sample its arrival region."""
_MAX_PLACES = 100
"""Number of places that sample the region in which a robot counts as arrived."""


@dataclass(frozen=True)
class Passages:
    """Narrowest gaps on the paths of some movers.

    Attributes:
        barriers: The obstacles and the gaps between them.
        found: (object id, index of the goal) -> the narrowest gap on the widest path (None if all gaps are wide), and
            whether that gap is too narrow for the body. Paths that were not examined are missing.
    """

    barriers: Gaps
    found: dict[tuple[int, int], tuple[Gap | None, bool]]


def passages_of(
    context: Context, scene: Scene, movers: list[Mover], blocked_goals: set[tuple[int, int]], *, ease: float
) -> Passages | None:
    """Find the narrowest gaps on the paths of movers for which cells are too coarse.

    Args:
        context: The scenario.
        scene: The initial poses and goals.
        movers: The movers.
        blocked_goals: (object id, index of the goal) pairs whose goal lies in or too near to an obstacle.
        ease: A gap counts as wide if it is this many times as wide as the robot.

    Returns:
        The gaps, None if there are too many obstacles.
    """
    open_edge = context.scenario.world.boundary == "none"
    key = f"barriers {max(m.radius for m in movers)}"
    if key not in scene.owner.kept:
        most = 2 * ease * max(m.radius for m in movers)
        scene.owner.kept[key] = find_gaps(scene.owner, most=most, open_edge=open_edge)
    barriers: Gaps | None = scene.owner.kept[key]
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
            places, radius = _arrival_places(scene, mover, (goal[0], goal[1]))
            if (mover.record.id, index) in blocked_goals or len(ways) + len(places) > barriers.max_paths:
                break
            if not places:  # the arrival region is too large to sample
                found[mover.record.id, index] = None, False
                start = (goal[0], goal[1])
                continue
            asked.append(((mover.record.id, index), mover, radius, range(len(ways), len(ways) + len(places))))
            ways += [(start, place) for place in places]
            start = places[0]
    openings = barriers.openings(ways)
    for pair, mover, radius, of_mover in asked:
        widest = max((openings[k] for k in of_mover), key=lambda opening: opening.width)
        closed = widest.width < 2 * radius * (1 - _SLACK)
        narrow = closed or 2 * mover.radius <= widest.width < 2 * ease * mover.radius
        found[pair] = (Gap(widest.width, widest.place, 0.0) if narrow else None, closed)
    return Passages(barriers, found)


def _arrival_places(scene: Scene, mover: Mover, goal: Point) -> tuple[list[Point], float]:
    """Places that sample the region in which a mover counts as arrived.

    Returns:
        The places, and the radius of a disc that can reach one of them whenever the body can reach the region.
    """
    if not _hits(scene, goal, mover.radius + mover.reach):
        return [goal], mover.radius
    apart = mover.reach * math.sqrt(math.pi / _MAX_PLACES)
    radius = mover.radius - apart * math.sqrt(0.5)
    if radius < _MIN_RADIUS_SHARE * mover.radius:
        return [], 0.0
    count = math.ceil(mover.reach / apart) + 1
    around = mover.reach + apart
    steps = [(apart * i, apart * j) for i in range(-count, count + 1) for j in range(-count, count + 1)]
    steps.sort(key=lambda step: math.hypot(*step))
    places = [(goal[0] + dx, goal[1] + dy) for dx, dy in steps if math.hypot(dx, dy) <= around]
    return [place for place in places if not _hits(scene, place, radius)], radius


def _hits(scene: Scene, place: Point, radius: float) -> bool:
    return scene.terrain.collides([core.Circle(radius=radius, center=[0, 0])], (*place, 0.0))
