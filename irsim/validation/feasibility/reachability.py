"""Whether robots can get from goal to goal, through gaps as wide as they are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

import irsim._core as core
from irsim.scenario.checks import Context
from irsim.validation.feasibility.clearance_grid import Gap, Point, Room, gap, plugged, reached_place, room_of
from irsim.validation.feasibility.gaps import barriers_of
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.passages import Passages, passages_of
from irsim.validation.feasibility.planner_check import missed_way
from irsim.validation.feasibility.scenes import Scene
from irsim.validation.feasibility.tally import Tally

__all__ = ["Leg", "check"]

_TIGHT = 1.25
"""A gap less than this many times as wide as the robot is narrow."""
_MOST_GAPS = 4
"""Gaps that are measured among the same things."""
_MOST_PLUGS = 2
"""Gaps that are closed, one after the other, to see whether there is another way."""
_MOST_QUERIES = 20_000
_COARSE, _BLIND = 0.5, 0.8
"""Cells larger than this share of a radius are not what gaps are looked for with, if there is another way; those larger
than that let everybody pass through thin walls."""
_SAMPLES, _FEW = 14, 0.05
"""Random goals that are tried along each axis; a share that does not matter."""


@dataclass(frozen=True)
class Leg:
    """The way of a robot from one goal to the next.

    Attributes:
        mover: Who.
        start: Middle of its inner disc at the start [m].
        goal: Goal [m].
        blocked: Something stands on the straight line.
        index: Of the goal.
    """

    mover: Mover
    start: Point
    goal: Point
    blocked: bool
    index: int


def check(
    context: Context,
    scene: Scene,
    movers: list[Mover],
    tally: Tally,
    *,
    blocking: bool,
    roomless: set[tuple[int, int]],
) -> dict[int, list[Leg]]:
    """The legs of each robot by its id; those that have no way are told of, and left out with all that follow.

    Args:
        context: The scenario.
        scene: Where everything stands.
        movers: Who moves.
        tally: Takes the findings.
        blocking: Whether things stop robots.
        roomless: (robot, goal) pairs that were told of already: ids and indices.
    """
    room = room_of(scene, movers) if scene.things and blocking else None
    legs: dict[int, list[Leg]] = {}
    kept, queries = scene.owner.kept, 0
    wanderers: set[object] = set()
    coarse = [] if room is None else [m for m in movers if room.cell > _COARSE * m.radius]
    passages = passages_of(context, scene, coarse, roomless, ease=_TIGHT) if coarse else None
    blind = {m.record.id for m in coarse if room is not None and room.cell > _BLIND * m.radius}
    far = {m.record.id for m in coarse} if passages is not None else set()
    for mover in sorted(movers, key=lambda m: m.record.role != "robot"):  # robots first: not all is looked at
        pose = scene.pose[mover.record.id]
        start = mover.centre(pose)
        if mover.record.wander:
            if (
                room is not None
                and mover.record.path not in wanderers
                and mover.record.id not in blind
                and room.holds(start)
            ):
                wanderers.add(mover.record.path)
                _wander(room, scene, mover, start, tally)
            continue
        made = legs.setdefault(mover.record.id, [])
        for index, goal in enumerate(scene.goals[mover.record.id]):
            to = (goal[0], goal[1])
            if room is None or not (room.holds(start) and room.holds(to)):
                made.append(Leg(mover, start, to, False, index))
                start = to
                continue
            queries += 1
            if (
                queries > _MOST_QUERIES
                or (mover.record.id, index) in roomless
                or _in_something(scene, mover, start, index)
            ):
                break
            if mover.record.id in far or mover.record.id in blind:
                if not _passes(context, scene, room, passages, mover, index, start, tally):
                    break
                made.append(Leg(mover, start, to, _crosses(scene, mover, start, to), index))
                start = to
                continue
            arrival = _arrival(room, mover, to)
            if arrival is None:
                break
            least = mover.radius - room.half
            found = None
            if room.clearance.widest(start, to, mover.reach)[0] >= least and kept.get("gaps", 0) < _MOST_GAPS:
                measured, found = _tightest(room, scene, mover, start, arrival)
                kept["gaps"] = kept.get("gaps", 0) + measured
            if found is not None and found.width + found.slack < 2 * mover.radius:
                _lost(context, room, scene, movers, mover, start, index, found, tally)
                break
            if room.clearance.widest(start, to, mover.reach)[0] < least:
                ends = _apart(room, mover, start, arrival)
                key = f"gap {ends}"
                if key not in kept:
                    kept[key] = gap(room, *ends)
                found = kept[key]
                _lost(context, room, scene, movers, mover, start, index, found, tally)
                break
            if found is not None and mover.record.role == "robot":
                _narrow(context, mover, index, found, scene, tally)
            made.append(Leg(mover, start, to, _line(room, mover, start, to), index))
            start = room.clearance.climb(arrival, mover.radius)
    return legs


def _in_something(scene: Scene, mover: Mover, start: Point, index: int) -> bool:
    """Whether it starts in an obstacle, which other checks tell."""
    if index:
        return False
    pose = scene.pose[mover.record.id]
    return scene.terrain.collides(mover.parts, pose)


def _arrival(room: Room, mover: Mover, goal: Point) -> Point | None:
    """The roomiest cell where it counts as arrived, None if there is hardly any room."""
    (x0, y0), (dx, dy), nx, ny = room.cells
    reach = mover.reach + room.half
    i0, i1 = (min(max(int((goal[0] + s * reach - x0) / dx), 0), nx - 1) for s in (-1, 1))
    j0, j1 = (min(max(int((goal[1] + s * reach - y0) / dy), 0), ny - 1) for s in (-1, 1))
    near = room.distance[i0 : i1 + 1, j0 : j1 + 1]
    i, j = np.unravel_index(int(near.argmax()), near.shape)
    if near[i, j] < mover.radius - room.half:
        return None
    return x0 + (i0 + int(i) + 0.5) * dx, y0 + (j0 + int(j) + 0.5) * dy


def _apart(room: Room, mover: Mover, start: Point, arrival: Point) -> tuple[Point, Point]:
    """Both ends, away from what they stand beside."""
    reach = 2 * mover.radius
    return room.clearance.climb(start, reach), room.clearance.climb(arrival, reach)


def _tightest(room: Room, scene: Scene, mover: Mover, start: Point, arrival: Point) -> tuple[int, Gap | None]:
    """How many gaps were measured, and the narrowest on the way if it is hardly as wide as the body, or not."""
    need, start_top, goal_top = 2 * mover.radius, *_apart(room, mover, start, arrival)
    closed: list[Gap] = []
    while len(closed) < _MOST_PLUGS:
        width = room.clearance.widest(start_top, goal_top, 0.0)[0]
        if closed and width < mover.radius - room.half:
            return len(closed), max(closed, key=lambda g: g.width)
        if not math.isfinite(width) or 2 * width >= _TIGHT * need:
            return len(closed), None
        key = f"gap {need} {round(width, 9)} {len(closed)}"
        if key not in scene.owner.kept:
            scene.owner.kept[key] = gap(room, start_top, goal_top)
        found: Gap | None = scene.owner.kept[key]
        if found is None or found.width + found.slack >= need:
            narrow = found is not None and found.width < _TIGHT * need
            return len(closed) + 1, found if narrow else None
        closed.append(found)
        room = plugged(room, closed)
    return len(closed), None


def _passes(
    context: Context,
    scene: Scene,
    room: Room,
    passages: Passages | None,
    mover: Mover,
    index: int,
    start: Point,
    tally: Tally,
) -> bool:
    """Tell what is to be told of a way in a large world; False if there is none."""
    goal = scene.goals[mover.record.id][index]
    to = (goal[0], goal[1])
    pair = (mover.record.id, index)
    if passages is None or pair not in passages.found:
        if mover.record.role == "robot" and _crosses(scene, mover, start, to):
            _unchecked(mover, index, room, scene, tally)
        return True
    found, closed = passages.found[pair]
    if closed:
        outside = False
        if context.scenario.world.boundary == "none":
            inner = barriers_of(scene.owner, most=2 * mover.radius, open_edge=False)
            outside = inner is not None and inner.openings([(start, to)])[0].width >= 2 * mover.radius
        _no_way(context, scene, mover, index, found, None, outside, tally)
        return False
    if found is not None and mover.record.role == "robot":
        _narrow(context, mover, index, found, scene, tally)
    return True


def _crosses(scene: Scene, mover: Mover, start: Point, goal: Point) -> bool:
    """The same, exactly."""
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


def _unchecked(mover: Mover, index: int, room: Room, scene: Scene, tally: Tally) -> None:
    width, height = (room.box[2] - room.box[0], room.box[3] - room.box[1])
    tally.add(
        "way-unchecked",
        mover.goal_path(index),
        mover.record,
        f"something stands between '{mover.record.name}' and its goal, and whether there is a way is not known: "
        f"{width:g} m × {height:g} m with so many corners are too much to look for ways of {_metres(2 * mover.radius)}",
        "behavior: {name: follow}, and --simulate or a run: an event 'no_path' says that there is none",
        scene.seed,
        serious=False,
    )


def _lost(
    context: Context,
    room: Room,
    scene: Scene,
    movers: list[Mover],
    mover: Mover,
    start: Point,
    index: int,
    found: Gap | None,
    tally: Tally,
) -> None:
    """There is no way over cells that are fine enough."""
    x, y, *_ = scene.goals[mover.record.id][index]
    need, outside, place = 2 * mover.radius, False, None
    if not scene.rough:
        place = reached_place(room, (x, y), mover.radius, start, max(need / 2, _TIGHT * need / 2 - room.half))
    if context.scenario.world.boundary == "none":
        wider = room_of(scene, movers, 4 * max(m.around for m in movers) + 2 * room.cell)
        outside = wider.clearance.widest(start, (x, y), mover.reach)[0] >= mover.radius - wider.half
    _no_way(context, scene, mover, index, found, place, outside, tally)


def _no_way(
    context: Context,
    scene: Scene,
    mover: Mover,
    index: int,
    found: Gap | None,
    place: Point | None,
    outside: bool,
    tally: Tally,
) -> None:
    name, goals = mover.record.name, scene.goals[mover.record.id]
    goal, need = goals[index], 2 * mover.radius
    what = f"waypoint {index + 1} at" if len(goals) > 1 else "its goal"
    if found is None or found.width <= 0:
        why = "nothing is open between them, not even for a thinner one"
        fix = "an opening in what stands between"
    else:
        x, y = found.place
        wide = f"a gap of {_metres(found.width)} at ({x:.2f}, {y:.2f})" if found.width < need else "too narrow a gap"
        why = f"the widest way has {wide}, and it needs {'' if mover.is_disc else 'at least '}{_metres(need)}"
        fix = f"a gap of more than {_metres(need)} ({_metres(_TIGHT * need)} to pass with ease), or a narrower robot"
    if hasattr(context.scenario.world.obstacle_map, "fill"):
        fix += ", or a map with another 'seed' or a lower 'fill'"
    if place is not None:
        fix += f", or another goal: it can get to ({place[0]:.2f}, {place[1]:.2f})"
    if outside:
        why += ". Only outside of the world, whose edge is open, it could get round"
    tally.add(
        "goal-unreachable",
        mover.goal_path(index),
        mover.record,
        f"'{name}' cannot get to {what} ({goal[0]:g}, {goal[1]:g}): {why}",
        fix,
        scene.seed,
        serious=mover.record.role == "robot",
    )


def _narrow(context: Context, mover: Mover, index: int, found: Gap, scene: Scene, tally: Tally) -> None:
    need, name = 2 * mover.radius, mover.record.name
    x, y = found.place
    what = (
        f"the way of '{name}' leads through a gap of {_metres(found.width)} at ({x:.2f}, {y:.2f}): "
        f"{_metres(max(0.0, found.width - need) / 2)} to each side of its {_metres(need)}"
    )
    fix = f"{_metres(_TIGHT * need)} or more are easier to get through"
    missed = missed_way(context, scene, mover, index)
    if missed is not None:
        cells = "" if missed.cell is None else f" with cells of {_metres(missed.cell)}"
        planner = f"its planner '{missed.planner}'{cells}"
        what += (
            f". Alone it gets stuck on the path of {planner}"
            if missed.found
            else f". It stands still: {planner} does not find that way"
        )
        fix = f"a gap of {_metres(_TIGHT * need)} or more"
        if missed.finer is not None:
            fix = f"planner: {{name: astar, resolution: {missed.finer:g}}} in its behavior, or {fix}"
    tally.add("narrow-passage", mover.goal_path(index), mover.record, what, fix, scene.seed, serious=missed is not None)


def _metres(value: float) -> str:
    return f"{value:.3g} m" if value >= 0.1 else f"{value:.2g} m"


def _line(room: Room, mover: Mover, start: Point, goal: Point) -> bool:
    """Whether something stands on the straight line, short of where it has arrived."""
    length = math.dist(start, goal)
    share = max(0.0, 1.0 - mover.reach / length) if length > 0 else 0.0
    t = np.linspace(0.0, share, 2 + int(length / room.cell))[:, None]
    points = np.array(start) + t * (np.array(goal) - np.array(start))
    return bool(room.at(points).min() < mover.radius - room.half)


def _wander(room: Room, scene: Scene, mover: Mover, start: Point, tally: Tally) -> None:
    """Random goals are drawn without a look at what stands there."""
    if _in_something(scene, mover, start, 0):
        return
    low, high = mover.record.range_low, mover.record.range_high
    x = low[0] + (high[0] - low[0]) * (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    y = low[1] + (high[1] - low[1]) * (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    points = [(float(a), float(b)) for a in x for b in y if room.holds((float(a), float(b)))]
    lost = [p for p in points if room.clearance.widest(start, p, mover.reach)[0] < mover.radius - room.half]
    if len(lost) <= _FEW * len(points):
        return
    tally.add(
        "wander-blocked",
        mover.path,
        mover.record,
        f"about {len(lost) / len(points):.0%} of the random goals of '{mover.record.name}' lie in obstacles or behind "
        f"them, ({lost[0][0]:.2f}, {lost[0][1]:.2f}) for one: it would never get there",
        "range_low and range_high that span open space",
        scene.seed,
        serious=len(lost) > 0.5 * len(points),
    )
