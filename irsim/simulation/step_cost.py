"""How much work a step of a scenario is, estimated from the scenario and its start alone: never by a clock."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.scenario.resolve.body_size import parts_of
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario
from irsim.simulation.fog import fog_resolution
from irsim.simulation.simulation import Simulation

__all__ = ["UNIT", "step_work"]

UNIT = 3.0
"""Microseconds that one unit of work takes or less, on a core of 2020 or later: an object that a behavior moves."""
_BEAM, _DEEP, _NOISE, _BODY, _EDGE, _CELL = 0.003, 0.004, 0.025, 0.02, 0.01, 0.0006
"""Of a beam; of it per square root of the bodies in reach, a beam meets some of them; of its noise; of a scan per body
and per edge in reach; of a beam per cell of fog that it passes [µs]."""
_CORNER = 0.012
"""Of each further corner of what moves [µs]."""
_PAIR = {"rvo": 0.5, "sfm": 0.12}
"""Of a neighbour in reach, where a behavior looks at each [µs]."""
_WALL = {"rvo": 1.5, "sfm": 0.2, "orca": 0.12}
"""Of a body in reach that stands [µs]."""
_PYTHON = 90.0
"""Of one part of a step that Python computes [µs]."""
_PLAN_CELL = {"astar": 0.003, "jps": 0.01}
"""Of a plan, per cell of the world [µs]."""
_PLAN_SAMPLE, _PLAN_EDGE = 1.0, 2.0
"""Of a plan, per sample of a tree and per edge of a graph [µs]."""
_GOAL_STEPS = 100
"""Who wanders plans anew after about so many steps."""
_MOST_CORNERS = 16
"""Bodies with more corners may be large: they count as in reach everywhere."""

Floats = NDArray[np.float64]


def step_work(scenario: ResolvedScenario, simulation: Simulation) -> float:
    """Work of one step of the only world of a simulation, in units; one per object at least.

    Args:
        scenario: What is simulated.
        simulation: At the start: who is near whom there counts.
    """
    records = scenario.objects
    place: Floats = simulation.state.pose[: len(records), :2]
    corners = np.array(_corners(records), dtype=np.int64)
    still = np.array([record.static for record in records], dtype=bool)
    near = _Nearness(place, corners)
    work = _CORNER * float((corners[~still] - 1).sum())
    for row, record in enumerate(records):
        if record.sensors:
            work += sum(_scan(scenario, sensor, row, near) for sensor in record.sensors)
        if not record.static:
            work += _behavior(scenario, record, row, near, still)
    parts = len(simulation.measurements) + len(simulation.decisions)
    parts += sum(part is not None for part in (simulation.drives, simulation.hooks))
    return len(records) + (work + _PYTHON * parts) / UNIT


class _Nearness:
    """How many are near each object at the start.

    Attributes:
        place: (N, 2) positions [m].
        corners: (N,) of each body.
    """

    def __init__(self, place: Floats, corners: NDArray[np.int64]) -> None:
        self.place, self.corners = np.nan_to_num(place), corners
        self._known: dict[tuple[float, str], Floats] = {}

    def about(self, reach: float, what: str, weight: Callable[[], NDArray[Any]]) -> Floats:
        """(N,) sum of a weight per object over those within a distance, estimated by squares of that size."""
        key = (reach, what)
        if key not in self._known:
            value = weight().astype(float)
            if not 0 < reach < math.inf:
                self._known[key] = np.full(len(value), value.sum() if reach > 0 else 0.0)
            else:
                square = np.floor(np.clip(self.place / reach, -1e15, 1e15))
                _, which = np.unique(square, axis=0, return_inverse=True)
                inside = np.bincount(which.ravel(), weights=value)[which.ravel()]
                self._known[key] = np.minimum(math.pi * inside, value.sum())
        return self._known[key]


def _corners(records: list[ObjectRecord]) -> list[int]:
    """How many corners each body has, 1 of a disc."""
    known: dict[int, int] = {}
    for record in records:
        key = id(record.shape)
        if key not in known:
            known[key] = sum(_corners_of(part) for part in parts_of(record.shape))
    return [known[id(record.shape)] for record in records]


def _corners_of(part: Any) -> int:
    if isinstance(part, (core.Polygon, core.Linestring)):
        return max(1, len(part.vertices))
    return 1


def _scan(scenario: ResolvedScenario, sensor: Any, row: int, near: _Nearness) -> float:
    """Of one sensor [µs]."""
    beams = getattr(sensor, "number", 0)
    if not beams:
        return 0.0
    reach = float(getattr(sensor, "range_max", math.inf))
    bodies = float(near.about(reach, "bodies", lambda: np.ones(len(near.corners)))[row])
    small = near.about(reach, "edges", lambda: np.where(near.corners > _MOST_CORNERS, 0, near.corners))[row]
    edges = float(small) + float(near.corners[near.corners > _MOST_CORNERS].sum())
    noise = _NOISE if getattr(sensor, "noise", False) else 0.0
    fog = 0.0
    if scenario.world.fog_map:
        longest = min(reach, math.hypot(scenario.world.width, scenario.world.height))
        fog = _CELL * 2 * longest / fog_resolution(scenario)
    return beams * (_BEAM + _DEEP * math.sqrt(bodies) + noise + fog) + _BODY * bodies + _EDGE * edges


def _behavior(
    scenario: ResolvedScenario, record: ObjectRecord, row: int, near: _Nearness, still: NDArray[np.bool_]
) -> float:
    """Of who decides [µs]."""
    behavior: Any = record.behavior if record.group_behavior is None else record.group_behavior
    work = 0.0
    if getattr(behavior, "name", "") == "follow":
        work += UNIT + _plans(scenario, behavior, record, bool(still.any()))
        behavior = behavior.local
    name = getattr(behavior, "name", "")
    if name not in _WALL:
        return work
    reach = float(getattr(behavior, "neighborDist" if name == "orca" else "neighbor_threshold", math.inf))
    walls = near.about(reach, "still", lambda: still)[row]
    others = near.about(reach, "moving", lambda: ~still)[row]
    return work + _WALL[name] * float(walls) + _PAIR.get(name, 0.0) * float(others)


def _plans(scenario: ResolvedScenario, behavior: Any, record: ObjectRecord, anything: bool) -> float:
    """Of the plans that come again and again, per step [µs]; where nothing stands every way is straight."""
    often = 1.0 / _GOAL_STEPS if record.wander else 0.0
    if behavior.replan is not None:
        often = max(often, min(1.0, scenario.world.step_time / behavior.replan))
    return often * _plan(scenario, behavior.planner) if anything else 0.0


def _plan(scenario: ResolvedScenario, planner: Any) -> float:
    """Of one plan [µs]."""
    if planner.name in _PLAN_CELL:
        if planner.resolution is None and scenario.grid is not None:
            return _PLAN_CELL[planner.name] * math.prod(scenario.grid.size)
        size = planner.resolution or 0.1
        return _PLAN_CELL[planner.name] * scenario.world.width * scenario.world.height / size**2
    if hasattr(planner, "n_sample"):
        return float(_PLAN_EDGE * planner.n_sample * planner.n_knn)
    return _PLAN_SAMPLE * float(getattr(planner, "max_iter", 500))
