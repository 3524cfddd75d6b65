"""Findings about paths to goals: none that is wide enough, or one with a narrow gap."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import irsim._core as core
from irsim.common.text import metres
from irsim.components.planners.grid import AStar
from irsim.env import Env
from irsim.scenario.checks import Context
from irsim.validation.feasibility.clearance_grid import ClearanceGrid, Gap, Point, grid_of, reachable_place
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.scenes import FAR, StartState
from irsim.validation.feasibility.tally import Tally
from irsim.validation.scene_passages import Places, passages_of_legs

__all__ = ["EASE", "add_unreachable", "report_narrow", "report_no_path"]

EASE = 1.25
"""A gap narrower than this many times the width of the robot is reported as narrow."""
_MIN_SHARE = 0.9
"""Narrowest gap on the way that a robot drives, as a share of its width, that is reported instead of the widest way."""
_MAX_DRIVEN = 4
"""Number of robots of a scene whose ways are planned as they drive them."""
_MAX_PLACES = 3
"""Number of equally narrow gaps whose places are named."""
_BESIDE_M = 0.02
"""A gap is one of the map if the map is at most this far from its sides [m]."""


def report_no_path(
    context: Context,
    grid: ClearanceGrid,
    scene: StartState,
    movers: list[Mover],
    mover: Mover,
    start: Point,
    index: int,
    gap: Gap | None,
    tally: Tally,
) -> None:
    """Report a goal to which no path leads over cells that are fine enough."""
    x, y, *_ = scene.goals[mover.record.id][index]
    need, outside, place = 2 * mover.radius, False, None
    if not scene.rough:
        place = reachable_place(grid, (x, y), mover.radius, start, max(need / 2, EASE * need / 2 - grid.half))
    if context.scenario.world.boundary == "none":
        wider = grid_of(scene, movers, 4 * max(m.shape.around for m in movers) + 2 * grid.cell)
        outside = wider.clearance.widest(start, (x, y), mover.reach)[0] >= mover.radius - wider.half
    add_unreachable(context, scene, mover, index, gap, place, outside, tally)


def add_unreachable(
    context: Context,
    scene: StartState,
    mover: Mover,
    index: int,
    widest: Gap | None,
    place: Point | None,
    outside: bool,
    tally: Tally,
) -> None:
    """Add the finding ``goal-unreachable``.

    Args:
        context: The scenario.
        scene: The initial poses and goals.
        mover: The mover.
        index: Index of the goal.
        widest: The narrowest gap on the widest path, None if there is no opening at all.
        place: Another goal that can be reached, if one is known [m].
        outside: Whether a path leads outside the world, over its open edge.
        tally: Collects the finding.
    """
    name, goals = mover.record.name, scene.goals[mover.record.id]
    goal, need = goals[index], 2 * mover.radius
    what = f"waypoint {index + 1} at" if len(goals) > 1 else "its goal"
    fixes = [] if place is None else [f"another goal: it can get to ({place[0]:.2f}, {place[1]:.2f})"]
    if widest is None or widest.width <= 0:
        why = "obstacles separate them completely, without a gap even for a thinner robot"
        fixes = ["an opening in the obstacles between them", *fixes]
    else:
        x, y = widest.place
        wide = (
            f"a gap of {metres(widest.width, unlike=need)} at ({x:.2f}, {y:.2f})"
            if widest.width < need
            else "too narrow a gap"
        )
        why = f"the widest path has {wide}, and the robot needs {'' if mover.is_disc else 'at least '}{metres(need)}"
        gap = f"a gap of more than {metres(need)} ({metres(EASE * need)} to pass with ease)"
        fixes = [*fixes, "a narrower robot"] if _is_drawn(context, scene, widest) else [gap, "a narrower robot", *fixes]
    if hasattr(context.scenario.world.obstacle_map, "fill"):
        fixes.append("a map with another 'seed' or a lower 'fill'")
    if outside:
        why += ". A path around the obstacles exists only outside the world, whose edge is open"
    tally.add_goal(
        "goal-unreachable",
        mover,
        index,
        f"'{name}' cannot get to {what} ({goal[0]:g}, {goal[1]:g}): {why}",
        ", or ".join(fixes),
        serious=mover.record.role == "robot",
    )


def report_narrow(
    context: Context,
    mover: Mover,
    index: int,
    gap: Gap,
    scene: StartState,
    tally: Tally,
    grid: ClearanceGrid | None = None,
    start: Point | None = None,
) -> None:
    """Report a gap that is hardly wider than the robot, where the robot drives.

    Args:
        context: The scenario.
        mover: The robot.
        index: Index of the goal.
        gap: The narrowest gap on the widest path.
        scene: The initial poses and goals.
        tally: Collects the finding.
        grid: Distances to obstacles, if cells are fine enough to look for another goal.
        start: Where the leg begins [m].
    """
    need, name = 2 * mover.radius, mover.record.name
    width, places = _driven_gaps(context, scene, mover, index, gap)
    at = " and ".join(f"({x:.2f}, {y:.2f})" for x, y in places[:_MAX_PLACES])
    gaps = "a gap" if len(places) == 1 else f"{len(places)} gaps"
    what = (
        f"the path of '{name}' leads through {gaps} of {metres(width)} at {at}, which leave{'s' * (len(places) == 1)} "
        f"{metres(max(0.0, width - need) / 2)} on each side of its {metres(need)}"
    )
    drawn = _is_drawn(context, scene, Gap(width, places[0], 0.0))
    wider = f"a gap of {metres(EASE * need)} or more"
    other = _other_goal(scene, mover, index, grid, start) if drawn else wider
    fix = other if drawn else f"{wider} is easier to pass"
    missed = missed_way(context, scene, mover, index)
    if missed is not None:
        cells = "" if missed.cell is None else f" with cells of {metres(missed.cell)}"
        planner = f"its planner '{missed.planner}'{cells}"
        what += (
            f". Even alone it gets stuck on the path of {planner}"
            if missed.has_path
            else f". It does not move, because {planner} does not find that path"
        )
        fix = other
        if missed.finer is not None:
            fix = f"planner: {{name: astar, resolution: {missed.finer:g}}} in its behavior, or {fix}"
    tally.add_goal("narrow-passage", mover, index, what, fix, serious=missed is not None)


def _driven_gaps(
    context: Context, scene: StartState, mover: Mover, index: int, narrowest: Gap
) -> tuple[float, list[tuple[float, float]]]:
    """Width and places of the narrowest gaps on the way that a robot drives, as the table of a scenario tells them.

    If that way was not measured, it is the gap on the widest way.
    """
    kept: dict[str, Any] = scene.owner.kept
    key = f"driven {scene.seed} {mover.record.id}"
    if key not in kept and kept.get("driven", 0) < _MAX_DRIVEN:
        kept["driven"] = kept.get("driven", 0) + 1
        places = Places(scene.seed, scene.pose, scene.goals, scene.owner.things)
        kept[key] = passages_of_legs(context.resolved, places, mover.record.id)
    own = kept.get(key, {}).get((mover.record.id, index), [])
    width = min((gap for gap, _ in own), default=narrowest.width)
    if not own or not _MIN_SHARE * 2 * mover.radius <= width < EASE * 2 * mover.radius:
        return narrowest.width, [narrowest.place]
    return width, [place for _, place in own]


def _is_drawn(context: Context, scene: StartState, gap: Gap) -> bool:
    """Whether a gap is one of a map that is drawn by a seed, whose gaps cannot be widened one by one."""
    if not hasattr(context.scenario.world.obstacle_map, "fill"):
        return False
    maps = [thing for thing in scene.owner.things if any(isinstance(part, core.GridCells) for part in thing[0])]
    disc = core.Circle(radius=gap.width / 2 + gap.slack + _BESIDE_M, center=[0, 0])
    return bool(maps) and core.Terrain(FAR, maps).collides([disc], (*gap.place, 0.0))


def _other_goal(scene: StartState, mover: Mover, index: int, grid: ClearanceGrid | None, start: Point | None) -> str:
    """Another goal as advice, if possible one to which a wider path leads."""
    place = None
    if grid is not None and start is not None and not scene.rough:
        x, y, *_ = scene.goals[mover.record.id][index]
        place = reachable_place(grid, (x, y), mover.radius, start, EASE * mover.radius)
    where = "" if place is None else f": ({place[0]:.2f}, {place[1]:.2f}) is reached without such a gap"
    return f"another goal{where}, or a narrower robot, or a map with another 'seed' or a lower 'fill'"


_DEFAULT_CELL_M = 0.1
"""Cell size [m] of grid planners without a resolution and without a map."""
_MAX_COMMON_AREA = 2500.0
"""Largest world with a map [m^2] in which `follow` tries cells of the default size before the map's cells."""
_FINER_CELLS_M = (0.05, 0.03, 0.02)
"""Cell sizes [m] that are tried if the planner finds no path."""
_MAX_CELLS = 1_000_000
"""Number of cells of the world up to which the planner is tried with its own cell size."""
_MAX_FINE_CELLS = 350_000
"""Number of cells of the world up to which a finer cell size is tried."""
_MAX_ROUGH_CELLS = 20_000
"""Number of cells for both where several scenes are examined."""
_MAX_OBJECTS = 1000
"""Scenarios with more objects are not tried."""
_MAX_TRIES = 2
"""Number of goals that are tried in one scene."""
_MAX_STEPS = 2000
"""Number of steps of one try."""
_MAX_WORK = 200_000
"""Number of steps times objects of one try."""
_WINDOW_S = 5.0
"""Time [s] in which a robot that has not stopped moves or turns by at least ``_MIN_MOTION``."""
_MIN_MOTION = 0.2
"""Least motion [m or rad] in the window; for robots slower than 1 m/s in proportion to their speed."""


@dataclass(frozen=True)
class Missed:
    """A path that a robot misses, or on which it gets stuck.

    Attributes:
        planner: Name of the planner.
        has_path: Whether the planner finds a path, on which the robot nevertheless gets stuck.
        cell: Cell size of the planner, None if it has no cells [m].
        finer: Cell size with which `astar` leads the robot to its goal; None if none was found or tried [m].
    """

    planner: str
    has_path: bool
    cell: float | None
    finer: float | None


def missed_way(context: Context, scene: StartState, mover: Mover, index: int) -> Missed | None:
    """Find out whether a robot with behavior `follow` misses an existing path.

    Args:
        context: The scenario.
        scene: The initial poses and goals.
        mover: The robot, a disc.
        index: Index of the goal; the robot visits the goals before it first.

    Returns:
        The missed path; None if the robot arrives, if it plans no path, or if a try takes too much work.
    """
    behavior: Any = mover.record.behavior
    kept = scene.owner.kept
    if (
        mover.behavior != "follow"
        or behavior is None
        or not mover.is_disc
        or kept.get("planned", 0) >= (1 if scene.rough else _MAX_TRIES)
    ):
        return None
    kept["planned"] = kept.get("planned", 0) + 1
    planner = behavior.planner
    cell = _cell_size(context, planner)
    world = context.resolved.world
    area = world.width * world.height
    most = _MAX_ROUGH_CELLS if scene.rough else _MAX_CELLS
    if (cell is not None and area > most * cell**2) or len(context.resolved.objects) > _MAX_OBJECTS:
        return None
    ended = _try_alone(context, scene, mover, index, behavior)
    if ended == "arrives":
        return None
    for finer in () if "finer" in kept else _FINER_CELLS_M:  # only once in a scene
        if area > (_MAX_ROUGH_CELLS if scene.rough else _MAX_FINE_CELLS) * finer**2:
            break
        fine = AStar(resolution=finer)
        if (cell is None or finer < cell) and (
            _try_alone(context, scene, mover, index, behavior.model_copy(update={"planner": fine})) == "arrives"
        ):
            return Missed(planner.name, ended == "stuck", cell, finer)
    kept["finer"] = True
    return Missed(planner.name, ended == "stuck", cell, None)


def _cell_size(context: Context, planner: Any) -> float | None:
    if not hasattr(planner, "resolution"):
        return None
    if planner.resolution:
        return float(planner.resolution)
    grid, world = context.resolved.grid, context.resolved.world
    if grid is None:
        return _DEFAULT_CELL_M
    cell = float(max(grid.cell))
    return cell if world.width * world.height > _MAX_COMMON_AREA else min(cell, _DEFAULT_CELL_M)


def _try_alone(
    context: Context, scene: StartState, mover: Mover, index: int, behavior: Any
) -> Literal["arrives", "stuck", "no path"]:
    """Simulate the robot with all other moving objects out of its way; it also "arrives" if the steps run out."""
    records = []
    for row, record in enumerate(context.resolved.objects):
        if record.id == mover.record.id:
            mine, goals = row, scene.goals[record.id][: index + 1]
            records.append(record.with_sensors([], behavior=behavior, goals=goals, wander=False, loop=False))
        elif not record.static:
            records.append(record.with_sensors([], behavior=None, group_behavior=None, unobstructed=True))
        else:
            records.append(record)
    world = context.resolved.world.model_copy(update={"fog_map": False})
    env = Env(
        replace(context.resolved, objects=records, world=world),
        seed=scene.seed,
        display=False,
        headless=True,
        log_level="ERROR",
    )
    try:
        state_of = env.simulation.state
        chunk = max(1, math.ceil(_WINDOW_S / env.step_time))
        for _ in range(0, min(_MAX_STEPS, _MAX_WORK // len(records)), chunk):
            before = state_of.pose[mine].copy()
            env.advance(chunk, until_done=True)
            if any(
                event.kind == "no_path" and event.partner is None and event.object == mover.record.name
                for event in env.events
            ):
                return "no path"
            if state_of.arrived[mine]:
                return "arrives"
            moved = state_of.pose[mine] - before
            turned = abs(math.remainder(moved[2], math.tau))
            if state_of.stopped[mine] or max(math.hypot(*moved[:2]), turned) < _MIN_MOTION * min(1.0, mover.speed):
                return "stuck"
        return "arrives"
    finally:
        env.end(ending_time=0.0)
