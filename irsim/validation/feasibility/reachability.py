"""Whether robots can get from goal to goal through the gaps between obstacles."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

import irsim._core as core
from irsim.common.text import metres
from irsim.scenario.checks import Context
from irsim.scenario.resolve.kernels import parts_of
from irsim.validation.feasibility.clearance_grid import (
    ClearanceGrid,
    Gap,
    Point,
    grid_of,
    narrowest_gap,
    with_gaps_closed,
)
from irsim.validation.feasibility.gaps import Passages, find_gaps, passages_of
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.path_reports import EASE, add_unreachable, report_narrow, report_no_path
from irsim.validation.feasibility.scenes import StartState
from irsim.validation.feasibility.tally import Tally

__all__ = ["Leg", "check"]

_MAX_GAPS = 4
"""Number of gaps that are measured between the same obstacles."""
_MAX_CLOSED_GAPS = 2
"""Number of gaps that are closed, one after the other, to see whether there is another path."""
_MAX_LEGS = 20_000
"""Number of legs that are examined in one scene."""
_COARSE_CELL = 0.5
"""Cells larger than this share of a radius are too coarse to measure gaps, so the gaps are found without cells."""
_BLIND_CELL = 0.8
"""Cells larger than this share of a radius miss thin walls, so they are never used."""
_SAMPLES_PER_AXIS = 14
"""Number of random goals that are tried along each axis of the range."""
_MAX_BLOCKED_SHARE = 0.05
"""Share of blocked random goals up to which nothing is reported."""


@dataclass(frozen=True)
class Leg:
    """The part of a route from one goal to the next.

    Attributes:
        mover: The robot or moving obstacle.
        start: Middle of its inner disc at the start [m].
        goal: Position of the goal [m].
        blocked: Whether an obstacle stands on the straight line.
        index: Index of the goal.
    """

    mover: Mover
    start: Point
    goal: Point
    blocked: bool
    index: int


def check(
    context: Context,
    scene: StartState,
    movers: list[Mover],
    tally: Tally,
    *,
    blocking: bool,
    blocked_goals: set[tuple[int, int]],
) -> dict[int, list[Leg]]:
    """Find the legs of each mover; legs without a path are reported, and the legs after them are skipped.

    Args:
        context: The scenario.
        scene: The initial poses and goals.
        movers: The robots and moving obstacles.
        tally: Collects the findings.
        blocking: Whether obstacles stop robots.
        blocked_goals: (object id, index of the goal) pairs that have been reported already.

    Returns:
        Object id -> its legs.
    """
    grid = grid_of(scene, movers) if scene.things and blocking else None
    legs: dict[int, list[Leg]] = {}
    kept, queries = scene.owner.kept, 0
    wanderers: set[object] = set()
    coarse = [] if grid is None else [m for m in movers if grid.cell > _COARSE_CELL * m.radius]
    passages = passages_of(context, scene, coarse, blocked_goals, ease=EASE) if coarse else None
    blind = {m.record.id for m in coarse if grid is not None and grid.cell > _BLIND_CELL * m.radius}
    by_passages = {m.record.id for m in coarse} if passages is not None else set()
    for mover in sorted(
        movers, key=lambda m: m.record.role != "robot"
    ):  # robots first, as the number of measured gaps is bounded
        pose = scene.pose[mover.record.id]
        start = mover.centre(pose)
        if mover.record.wander:
            if (
                grid is not None
                and mover.record.path not in wanderers
                and mover.record.id not in blind
                and grid.holds(start)
            ):
                wanderers.add(mover.record.path)
                _check_wandering(grid, scene, mover, start, tally)
            continue
        made = legs.setdefault(mover.record.id, [])
        for index, goal in enumerate(scene.goals[mover.record.id]):
            to = (goal[0], goal[1])
            if grid is None or not (grid.holds(start) and grid.holds(to)):
                made.append(Leg(mover, start, to, False, index))
                start = to
                continue
            queries += 1
            if (
                queries > _MAX_LEGS
                or (mover.record.id, index) in blocked_goals
                or (index == 0 and _starts_in_obstacle(scene, mover))
            ):
                break
            if mover.record.id in by_passages or mover.record.id in blind:
                if not _check_passages(context, scene, grid, passages, mover, index, start, tally):
                    break
                made.append(Leg(mover, start, to, _is_swept_line_blocked(scene, mover, start, to), index))
                start = to
                continue
            arrival = _arrival_place(grid, mover, to)
            if arrival is None:
                break
            least = mover.radius - grid.half
            gap = None
            if grid.clearance.widest(start, to, mover.reach)[0] >= least and kept.get("gaps", 0) < _MAX_GAPS:
                measured, gap = _narrowest_on_path(grid, scene, mover, start, arrival)
                kept["gaps"] = kept.get("gaps", 0) + measured
            if gap is not None and gap.width + gap.slack < 2 * mover.radius:
                report_no_path(context, grid, scene, movers, mover, start, index, gap, tally)
                break
            if grid.clearance.widest(start, to, mover.reach)[0] < least:
                ends = _open_ends(grid, mover, start, arrival)
                key = f"gap {ends}"
                if key not in kept:
                    kept[key] = narrowest_gap(grid, *ends)
                gap = kept[key]
                report_no_path(context, grid, scene, movers, mover, start, index, gap, tally)
                break
            if gap is not None and mover.record.role == "robot":
                report_narrow(context, mover, index, gap, scene, tally, grid, start)
            made.append(Leg(mover, start, to, _is_line_blocked(grid, mover, start, to), index))
            start = grid.clearance.climb(arrival, mover.radius)
    return legs


def _starts_in_obstacle(scene: StartState, mover: Mover) -> bool:
    """Whether a mover starts in an obstacle, which other checks report."""
    return scene.terrain.collides(parts_of(mover.record.shape), scene.pose[mover.record.id])


def _arrival_place(grid: ClearanceGrid, mover: Mover, goal: Point) -> Point | None:
    """The cell farthest from obstacles at which a mover counts as arrived; None if the body does not fit there."""
    (x0, y0), (dx, dy), nx, ny = grid.cells
    reach = mover.reach + grid.half
    i0, i1 = (min(max(int((goal[0] + s * reach - x0) / dx), 0), nx - 1) for s in (-1, 1))
    j0, j1 = (min(max(int((goal[1] + s * reach - y0) / dy), 0), ny - 1) for s in (-1, 1))
    near = grid.distance[i0 : i1 + 1, j0 : j1 + 1]
    i, j = np.unravel_index(int(near.argmax()), near.shape)
    if near[i, j] < mover.radius - grid.half:
        return None
    return x0 + (i0 + int(i) + 0.5) * dx, y0 + (j0 + int(j) + 0.5) * dy


def _open_ends(grid: ClearanceGrid, mover: Mover, start: Point, arrival: Point) -> tuple[Point, Point]:
    """Both ends of a leg, moved away from obstacles beside them, so that only gaps on the path are measured."""
    reach = 2 * mover.radius
    return grid.clearance.climb(start, reach), grid.clearance.climb(arrival, reach)


def _narrowest_on_path(
    grid: ClearanceGrid, scene: StartState, mover: Mover, start: Point, arrival: Point
) -> tuple[int, Gap | None]:
    """Number of gaps that were measured, and the narrowest gap on the path; None if all gaps are wide."""
    need, start_top, goal_top = 2 * mover.radius, *_open_ends(grid, mover, start, arrival)
    closed: list[Gap] = []
    while len(closed) < _MAX_CLOSED_GAPS:
        width = grid.clearance.widest(start_top, goal_top, 0.0)[0]
        if closed and width < mover.radius - grid.half:
            return len(closed), max(closed, key=lambda g: g.width)
        if not math.isfinite(width) or 2 * width >= EASE * need:
            return len(closed), None
        key = f"gap {need} {round(width, 9)} {len(closed)}"
        if key not in scene.owner.kept:
            scene.owner.kept[key] = narrowest_gap(grid, start_top, goal_top)
        gap: Gap | None = scene.owner.kept[key]
        if gap is None or gap.width + gap.slack >= need:
            narrow = gap is not None and gap.width < EASE * need
            return len(closed) + 1, gap if narrow else None
        closed.append(gap)
        grid = with_gaps_closed(grid, closed)
    return len(closed), None


def _check_passages(
    context: Context,
    scene: StartState,
    grid: ClearanceGrid,
    passages: Passages | None,
    mover: Mover,
    index: int,
    start: Point,
    tally: Tally,
) -> bool:
    """Report a narrow or missing path of a mover for which cells are too coarse.

    Returns:
        False if there is certainly no path.
    """
    goal = scene.goals[mover.record.id][index]
    to = (goal[0], goal[1])
    pair = (mover.record.id, index)
    if passages is None or pair not in passages.gaps:
        if mover.record.role == "robot" and _is_swept_line_blocked(scene, mover, start, to):
            _report_unchecked(mover, index, grid, tally)
        return True
    gap, closed = passages.gaps[pair]
    if closed:
        outside = False
        if context.scenario.world.boundary == "none":
            inner = find_gaps(scene.owner, most=2 * mover.radius, open_edge=False)
            outside = inner is not None and inner.openings([(start, to)])[0].width >= 2 * mover.radius
        add_unreachable(context, scene, mover, index, gap, None, outside, tally)
        return False
    if gap is not None and mover.record.role == "robot":
        report_narrow(context, mover, index, gap, scene, tally)
    return True


def _is_swept_line_blocked(scene: StartState, mover: Mover, start: Point, goal: Point) -> bool:
    """Whether the disc hits an obstacle on the straight line before it counts as arrived; exact, without cells."""
    length = math.dist(start, goal)
    left = length - mover.reach
    if left <= 0:
        return False
    ux, uy = (goal[0] - start[0]) / length, (goal[1] - start[1]) / length
    r = mover.radius * (1 - 1e-9)
    corners = [
        [start[0] + t * ux - side * uy, start[1] + t * uy + side * ux]
        for t, side in ((0, -r), (left, -r), (left, r), (0, r))
    ]
    return scene.terrain.collides([core.Polygon(vertices=corners)], (0.0, 0.0, 0.0))


def _report_unchecked(mover: Mover, index: int, grid: ClearanceGrid, tally: Tally) -> None:
    width, height = (grid.box[2] - grid.box[0], grid.box[3] - grid.box[1])
    tally.add_goal(
        "way-unchecked",
        mover,
        index,
        f"an obstacle stands between '{mover.record.name}' and its goal, and it is not known whether there is a path: "
        f"a world of {width:g} m × {height:g} m with this many corners is too large to search for paths "
        f"{metres(2 * mover.radius)} wide",
        "behavior: {name: follow}, and --simulate or a run: an event 'no_path' means that there is no path",
        serious=False,
    )


def _is_line_blocked(grid: ClearanceGrid, mover: Mover, start: Point, goal: Point) -> bool:
    """Whether an obstacle stands on the straight line before the mover counts as arrived."""
    length = math.dist(start, goal)
    share = max(0.0, 1.0 - mover.reach / length) if length > 0 else 0.0
    t = np.linspace(0.0, share, 2 + int(length / grid.cell))[:, None]
    points = np.array(start) + t * (np.array(goal) - np.array(start))
    return bool(grid.at(points).min() < mover.radius - grid.half)


def _check_wandering(grid: ClearanceGrid, scene: StartState, mover: Mover, start: Point, tally: Tally) -> None:
    """Report a wandering mover that cannot reach many of its random goals, which are drawn regardless of obstacles."""
    if _starts_in_obstacle(scene, mover):
        return
    low, high = mover.record.range_low, mover.record.range_high
    x = low[0] + (high[0] - low[0]) * (np.arange(_SAMPLES_PER_AXIS) + 0.5) / _SAMPLES_PER_AXIS
    y = low[1] + (high[1] - low[1]) * (np.arange(_SAMPLES_PER_AXIS) + 0.5) / _SAMPLES_PER_AXIS
    points = [(float(a), float(b)) for a in x for b in y if grid.holds((float(a), float(b)))]
    blocked = [p for p in points if grid.clearance.widest(start, p, mover.reach)[0] < mover.radius - grid.half]
    if len(blocked) <= _MAX_BLOCKED_SHARE * len(points):
        return
    tally.add(
        "wander-blocked",
        mover.path,
        mover.record,
        f"about {len(blocked) / len(points):.0%} of the random goals of '{mover.record.name}' lie in obstacles or "
        f"behind them, for example ({blocked[0][0]:.2f}, {blocked[0][1]:.2f}), and can never be reached",
        "range_low and range_high that span open space",
        serious=len(blocked) > 0.5 * len(points),
    )
