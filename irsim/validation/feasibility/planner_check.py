"""Whether the planner of a robot finds an existing path, tried by simulating the robot alone."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

from irsim.components.planners.astar import AStar
from irsim.env import Env
from irsim.scenario.checks import Context
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.scenes import Scene

__all__ = ["Missed", "missed_way"]

_DEFAULT_CELL_M = 0.1
"""Cell size [m] of grid planners without a resolution and without a map."""
_MAX_COMMON_AREA = 2500.0
"""Largest world with a map [m^2] in which `follow` tries cells of the default size before those of the map."""
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
        found: Whether the planner finds a path, on which the robot nevertheless gets stuck.
        cell: Cell size of the planner, None if it has no cells [m].
        finer: Cell size with which `astar` leads the robot to its goal; None if none was found or tried [m].
    """

    planner: str
    found: bool
    cell: float | None
    finer: float | None


def missed_way(context: Context, scene: Scene, mover: Mover, index: int) -> Missed | None:
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
    context: Context, scene: Scene, mover: Mover, index: int, behavior: Any
) -> Literal["arrives", "stuck", "no path"]:
    """Simulate the robot with all other moving objects out of its way; it also "arrives" if the steps run out."""
    records = []
    for row, record in enumerate(context.resolved.objects):
        if record.id == mover.record.id:
            mine, goals = row, scene.goals[record.id][: index + 1]
            records.append(replace(record, behavior=behavior, goals=goals, sensors=[], wander=False, loop=False))
        elif not record.static:
            records.append(replace(record, sensors=[], behavior=None, group_behavior=None, unobstructed=True))
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
