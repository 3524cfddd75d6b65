"""Whether a robot that plans finds the way that there is: it goes there alone, until it arrives or stands."""

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

_CELL = 0.1
"""Of grid planners without a resolution and without a map [m]."""
_FINER = (0.05, 0.03, 0.02)
_MOST_CELLS, _MOST_FINE, _MOST_ROUGH = 1_000_000, 350_000, 20_000
"""Of the world at the size that the robot plans with, at those that are tried, and where several scenes are."""
_MOST_OBJECTS = 1000
_MOST = 2
"""Ways that are tried in one scene."""
_MOST_STEPS, _MOST_WORK = 2000, 200_000
"""Of one try; and steps times objects."""
_PAUSE, _STILL = 5.0, 0.2
"""Who gets no farther and does not turn in so many seconds stands [s], [m], [rad]; less where slower than 1 m/s."""


@dataclass(frozen=True)
class Missed:
    """A way on which a robot gets stuck.

    Attributes:
        planner: Name of the planner.
        found: It finds a path, on which the robot stands still all the same.
        cell: Size of its cells, None if it has none [m].
        finer: Cells with which `astar` leads it there; None if none were found or tried [m].
    """

    planner: str
    found: bool
    cell: float | None
    finer: float | None


def missed_way(context: Context, scene: Scene, mover: Mover, index: int) -> Missed | None:
    """What a robot under `follow` misses; None if it gets there, if it plans nothing, or if to see that is too much.

    Args:
        context: The scenario.
        scene: Where everything stands.
        mover: The robot, a disc.
        index: Of the goal; those before it are on the way.
    """
    behavior: Any = mover.record.behavior
    kept = scene.owner.kept
    if (
        mover.behavior != "follow"
        or behavior is None
        or not mover.is_disc
        or kept.get("planned", 0) >= (1 if scene.rough else _MOST)
    ):
        return None
    kept["planned"] = kept.get("planned", 0) + 1
    planner = behavior.planner
    cell = _cell(context, planner)
    world = context.resolved.world
    area = world.width * world.height
    most = _MOST_ROUGH if scene.rough else _MOST_CELLS
    if (cell is not None and area > most * cell**2) or len(context.resolved.objects) > _MOST_OBJECTS:
        return None
    ended = _tried(context, scene, mover, index, behavior)
    if ended == "fine":
        return None
    for finer in () if "finer" in kept else _FINER:  # once in a scene
        if area > (_MOST_ROUGH if scene.rough else _MOST_FINE) * finer**2:
            break
        fine = AStar(resolution=finer)
        if (cell is None or finer < cell) and (
            _tried(context, scene, mover, index, behavior.model_copy(update={"planner": fine})) == "fine"
        ):
            return Missed(planner.name, ended == "stands", cell, finer)
    kept["finer"] = True
    return Missed(planner.name, ended == "stands", cell, None)


def _cell(context: Context, planner: Any) -> float | None:
    if not hasattr(planner, "resolution"):
        return None
    grid = context.resolved.grid
    return float(planner.resolution or (max(grid.cell) if grid is not None else _CELL))


def _tried(
    context: Context, scene: Scene, mover: Mover, index: int, behavior: Any
) -> Literal["fine", "stands", "no path"]:
    """What becomes of it alone; others are in nobody's way."""
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
        chunk = max(1, math.ceil(_PAUSE / env.step_time))
        for _ in range(0, min(_MOST_STEPS, _MOST_WORK // len(records)), chunk):
            before = state_of.pose[mine].copy()
            env.advance(chunk, until_done=True)
            if any(event.kind == "no_path" and event.object == mover.record.name for event in env.events):
                return "no path"
            if state_of.arrived[mine]:
                return "fine"
            moved = state_of.pose[mine] - before
            turned = abs(math.remainder(moved[2], math.tau))
            if state_of.stopped[mine] or max(math.hypot(*moved[:2]), turned) < _STILL * min(1.0, mover.speed):
                return "stands"
        return "fine"
    finally:
        env.end(ending_time=0.0)
