"""The routes that the behavior ``follow`` plans, goal after goal, without driving them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from irsim.common.arrays import Floats
from irsim.env import Env
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

__all__ = ["planned_routes"]

_MAX_LEGS = 40
"""Number of legs, from one goal to the next, after which nothing is planned for further objects."""
_MAX_OBJECTS = 5000
"""Nothing is planned in larger scenarios."""

Route = Floats | None


def planned_routes(
    scenario: ResolvedScenario,
    seed: int,
    poses: Mapping[int, Sequence[float]],
    goals: Mapping[int, Sequence[Sequence[float]]],
) -> dict[int, list[Route]]:
    """Plan the routes of the objects with the behavior ``follow``, each leg by the planner of its behavior.

    One step is simulated for each leg, with every object at the goal before, so that the route is the one that the
    object drives. Objects that move do not take part.

    Args:
        scenario: The scenario.
        seed: Seed of its random shapes and maps.
        poses: Object id -> x, y [m] and heading [rad] at the start, of all objects.
        goals: Object id -> goals to visit, of the objects to plan for: x, y [m], and perhaps a heading [rad].

    Returns:
        Object id -> (K, 2) corners of the route to each goal [m]. A route to which there is no path is None, and the
        last of its object. Objects of other behaviors are missing, and the last ones if there is too much to plan.
    """
    ways = _asked(scenario, goals) if len(scenario.objects) <= _MAX_OBJECTS else {}
    if not ways:
        return {}
    starts = {key: [float(value) for value in pose[:3]] for key, pose in poses.items()}
    routes: dict[int, list[Route]] = {key: [] for key in ways}
    for leg in range(max(map(len, ways.values()))):
        asked = {
            key: way[leg] for key, way in ways.items() if leg < len(way) and all(one is not None for one in routes[key])
        }
        for key, route in _routes_of_leg(scenario, seed, starts, asked).items():
            routes[key].append(route)
            if route is not None and len(route) > 1:
                (x, y), (dx, dy) = route[-1], route[-1] - route[-2]
                starts[key] = [float(x), float(y), math.atan2(dy, dx)]
    return routes


def _asked(
    scenario: ResolvedScenario, goals: Mapping[int, Sequence[Sequence[float]]]
) -> dict[int, Sequence[Sequence[float]]]:
    """The goals of the first objects that follow routes, until there are many legs."""
    asked: dict[int, Sequence[Sequence[float]]] = {}
    legs = 0
    for record in scenario.objects:
        if legs < _MAX_LEGS and getattr(record.behavior, "name", "") == "follow" and goals.get(record.id):
            asked[record.id] = goals[record.id]
            legs += len(goals[record.id])
    return asked


def _routes_of_leg(
    scenario: ResolvedScenario, seed: int, starts: Mapping[int, list[float]], goals: Mapping[int, Sequence[float]]
) -> dict[int, Route]:
    """The routes of some objects to one goal each."""
    records = [_placed(record, starts[record.id], goals.get(record.id)) for record in scenario.objects]
    world = scenario.world.model_copy(update={"fog_map": False, "collision_mode": "unobstructed"})
    env = Env(
        replace(scenario, objects=records, placements=[], world=world),
        seed=seed,
        display=False,
        headless=True,
        log_level="ERROR",
    )
    try:
        env.step()
        rows = {view.id: view.row for view in env.objects}
        return {key: env.simulation.state.route(rows[key]) for key in goals}
    finally:
        env.end(ending_time=0.0)


def _placed(record: ObjectRecord, pose: list[float], goal: Sequence[float] | None) -> ObjectRecord:
    """An object at a pose, with one goal; one without a goal does nothing and, if it moves, is passable."""
    state = [*pose, *record.state[3:]]
    if goal is None and record.static:
        return replace(record, state=state)
    rest: dict[str, Any] = {"wander": False, "loop": False, "appear_time": 0.0, "start_time": 0.0, "spreads": None}
    if goal is None:
        return record.with_sensors([], state=state, behavior=None, group_behavior=None, unobstructed=True, **rest)
    return record.with_sensors([], state=state, goals=[[float(value) for value in goal]], **rest)
