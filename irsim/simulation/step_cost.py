"""Estimates the computing work of one step from the scenario and its initial state, without measuring time.

The estimate is deterministic, so a limit on work stops the same run at the same step on every machine.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.scenario.resolve.kernels import parts_of
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario
from irsim.simulation.build import is_watching
from irsim.simulation.fog import fog_resolution
from irsim.simulation.simulation import Simulation

__all__ = ["UNIT", "step_work"]

UNIT = 3.0
"""Time [µs] that one unit of work takes at most on a processor core of 2020 or later.

One unit is the work of one object that a behavior moves.
"""
_BEAM_US = 0.003
"""Time of one beam [µs]."""
_BEAM_DEPTH_US = 0.004
"""Time of one beam per square root of the number of bodies in range [µs]: a beam passes close to some of them."""
_BEAM_NOISE_US = 0.025
"""Time of the noise of one beam [µs]."""
_SCAN_BODY_US = 0.02
"""Time of a scan per body in range [µs]."""
_SCAN_EDGE_US = 0.01
"""Time of a scan per edge in range [µs]."""
_FOG_CELL_US = 0.0006
"""Time of one beam per cell of fog that it passes [µs]."""
_CORNER_US = 0.012
"""Time of each corner after the first of a moving body [µs]."""
_NEIGHBOR_US = {"rvo": 0.5, "sfm": 0.12, "footprint_orca": 0.5}
"""Time per moving neighbor in range, for behaviors that consider each neighbor [µs]."""
_STATIC_BODY_US = {"rvo": 1.5, "sfm": 0.2, "orca": 0.12, "avocado": 0.12, "footprint_orca": 0.3}
"""Time per static body in range [µs]."""
_ZONE_US = 0.01
"""Time of one zone per moving body [µs]."""
_VIEW_BODY_US = 0.006
"""Time of a watched field of view per body [µs]."""
_SEEN_BODY_US = 0.06
"""Time of a watched field of view per body in range [µs]."""
_OCCLUSION_US = 0.7
"""Additional time per body in range with occlusion [µs]."""
_BLOCKER_US = 0.03
"""Additional time per body in range and body that may hide it [µs]."""
_PYTHON_PART_US = 90.0
"""Time of each part of a step that Python computes [µs]."""
_PLAN_CELL_US = {"astar": 0.003, "jps": 0.01}
"""Time of a plan per cell of the world [µs]."""
_PLAN_SAMPLE_US = 1.0
"""Time of a plan per sample of a tree [µs]."""
_PLAN_EDGE_US = 2.0
"""Time of a plan per edge of a graph [µs]."""
_WANDER_REPLAN_STEPS = 100
"""Number of steps after which a wandering robot replans, on average."""
MAX_SMALL_BODY_CORNERS = 16
"""A body with more corners is possibly large, so it counts as in range everywhere."""


def step_work(scenario: ResolvedScenario, simulation: Simulation) -> float:
    """Estimate the work of one step of a simulation with a single world, in units; at least one per object.

    Args:
        scenario: The scenario of the simulation.
        simulation: The simulation in its initial state, whose distances between objects are used.
    """
    records = scenario.objects
    place: Floats = simulation.state.pose[: len(records), :2]
    corners = np.array(_corners(records), dtype=np.int64)
    static = np.array([record.static for record in records], dtype=bool)
    near = _Nearness(place, corners)
    work = _CORNER_US * float((corners[~static] - 1).sum())
    work += _ZONE_US * len(scenario.world.zones) * int((~static).sum())
    for row, record in enumerate(records):
        if is_watching(record):
            work += _view_time(record, row, near)
        if record.sensors:
            work += sum(_scan_time(scenario, sensor, row, near) for sensor in record.sensors)
        if not record.static:
            work += _behavior_time(scenario, record, row, near, static)
    parts = len(simulation.measurements) + len(simulation.decisions)
    parts += sum(part is not None for part in (simulation.drives, simulation.hooks))
    return len(records) + (work + _PYTHON_PART_US * parts) / UNIT


class _Nearness:
    """Number of bodies near each object in the initial state.

    Attributes:
        place: (N, 2) positions [m].
        corners: (N,) number of corners of each body.
    """

    def __init__(self, place: Floats, corners: NDArray[np.int64]) -> None:
        self.place, self.corners = np.nan_to_num(place), corners
        self._known: dict[tuple[float, str], Floats] = {}

    def estimate(self, reach: float, what: str, weight: Callable[[], NDArray[Any]]) -> Floats:
        """Estimate the (N,) sums of a weight over the objects within a distance of each object.

        The estimate counts objects in squares of that size, because exact distances of all pairs take too long.

        Args:
            reach: Distance [m].
            what: Name of the weight, which identifies it in the cache.
            weight: Returns the (N,) weights.
        """
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
    """Return the number of corners of each body; a disc counts as 1."""
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


def _scan_time(scenario: ResolvedScenario, sensor: Any, row: int, near: _Nearness) -> float:
    """Estimate the time of one sensor per step [µs]."""
    beams = getattr(sensor, "number", 0)
    if not beams:
        return 0.0
    reach = float(getattr(sensor, "range_max", math.inf))
    bodies = float(near.estimate(reach, "bodies", lambda: np.ones(len(near.corners)))[row])
    is_large = near.corners > MAX_SMALL_BODY_CORNERS
    edges = float(near.estimate(reach, "edges", lambda: np.where(is_large, 0, near.corners))[row])
    edges += float(near.corners[is_large].sum())
    noise = _BEAM_NOISE_US if getattr(sensor, "noise", False) else 0.0
    fog = 0.0
    if scenario.world.fog_map:
        longest = min(reach, math.hypot(scenario.world.width, scenario.world.height))
        fog = _FOG_CELL_US * 2 * longest / fog_resolution(scenario)
    beam = _BEAM_US + _BEAM_DEPTH_US * math.sqrt(bodies) + noise + fog
    share = min(1.0, (getattr(sensor, "rate", None) or math.inf) * scenario.world.step_time)
    return share * (beams * beam + _SCAN_BODY_US * bodies + _SCAN_EDGE_US * edges)


def _view_time(record: ObjectRecord, row: int, near: _Nearness) -> float:
    """Estimate the time of a watched field of view per step [µs]."""
    bodies = len(near.corners)
    there = float(near.estimate(record.fov_radius or 0.0, "bodies", lambda: np.ones(bodies))[row])
    hidden = _OCCLUSION_US + _BLOCKER_US * there if record.fov_occlusion else 0.0
    return _VIEW_BODY_US * bodies + (_SEEN_BODY_US + hidden) * there


def _behavior_time(
    scenario: ResolvedScenario, record: ObjectRecord, row: int, near: _Nearness, static: NDArray[np.bool_]
) -> float:
    """Estimate the time of the behavior of one object per step [µs]."""
    behavior: Any = record.active_behavior
    work = 0.0
    if getattr(behavior, "name", "") == "follow":
        work += UNIT + _replanning_time(scenario, behavior, record, bool(static.any()))
        behavior = behavior.local
    name = getattr(behavior, "name", "")
    if name not in _STATIC_BODY_US:
        return work
    reach = float(getattr(behavior, "neighborDist", getattr(behavior, "neighbor_threshold", math.inf)))
    static_bodies = near.estimate(reach, "static", lambda: static)[row]
    neighbors = near.estimate(reach, "moving", lambda: ~static)[row]
    return work + _STATIC_BODY_US[name] * float(static_bodies) + _NEIGHBOR_US.get(name, 0.0) * float(neighbors)


def _replanning_time(scenario: ResolvedScenario, behavior: Any, record: ObjectRecord, has_static: bool) -> float:
    """Estimate the time of repeated plans per step [µs]; without static bodies each path is a straight line."""
    plans_per_step = 1.0 / _WANDER_REPLAN_STEPS if record.wander else 0.0
    if behavior.replan is not None:
        plans_per_step = max(plans_per_step, min(1.0, scenario.world.step_time / behavior.replan))
    return plans_per_step * _plan_time(scenario, behavior.planner) if has_static else 0.0


def _plan_time(scenario: ResolvedScenario, planner: Any) -> float:
    """Estimate the time of one plan [µs]."""
    if planner.name in _PLAN_CELL_US:
        if planner.resolution is None and scenario.grid is not None:
            return _PLAN_CELL_US[planner.name] * math.prod(scenario.grid.size)
        size = planner.resolution or 0.1
        return _PLAN_CELL_US[planner.name] * scenario.world.width * scenario.world.height / size**2
    if hasattr(planner, "n_sample"):
        return float(_PLAN_EDGE_US * planner.n_sample * planner.n_knn)
    return _PLAN_SAMPLE_US * float(getattr(planner, "max_iter", 500))
