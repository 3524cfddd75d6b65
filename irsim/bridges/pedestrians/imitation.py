"""Behaviors in the place of recorded people: each person walks on by itself, among the recorded others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, TypeAlias

import numpy as np
import yaml

from irsim.bridges.pedestrians.cases import FORETOLD, Cases
from irsim.bridges.pedestrians.tracks import PERIOD
from irsim.common.arrays import Floats
from irsim.components.options import BehaviorOptions
from irsim.diagnostics.diagnostic import format_path
from irsim.diagnostics.errors import ArgumentError, ScenarioError
from irsim.scenario.read import or_raise, read
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.document import load_text
from irsim.simulation.simulation import Simulation

__all__ = ["GOALS", "RADIUS", "GoalName", "goals_of", "imitate", "keep_velocity"]

GoalName: TypeAlias = Literal["recorded", "extrapolated"]
GOALS: tuple[GoalName, ...] = ("recorded", "extrapolated")
"""Where a person wants to go: where its recording ends, or straight on from what was seen of it."""
RADIUS = 0.2
"""Radius of a person [m]."""
STEPS_OF_A_ROW = 4
"""Steps of the simulation between two rows."""
_AHEAD = 60.0
"""Time after which a person at its mean velocity would be at the extrapolated goal, so that it never gets there [s]."""
_AWAY = 1000.0
"""Where those stand who are not there: farther away than any behavior looks [m]."""
_APART = 100.0
"""Distance between them [m]."""
_SLOWEST = 1e-6
"""Least wanted speed [m/s]."""
_FASTEST = 50.0
"""Top speed of the recorded others [m/s]."""


def keep_velocity(cases: Cases) -> Floats:
    """(W, 12, 2) places of people who keep their last known velocity (the constant velocity model)."""
    ahead = PERIOD * np.arange(1, FORETOLD + 1)
    result: Floats = cases.start[:, None] + cases.velocity[:, None] * ahead[None, :, None]
    return result


def goals_of(cases: Cases, kind: GoalName) -> Floats:
    """(W, 2) where the people want to go [m]."""
    return cases.goal if kind == "recorded" else cases.start + _AHEAD * cases.mean_velocity


def imitate(cases: Cases, behavior: Mapping[str, Any], goals: Floats, *, radius: float = RADIUS) -> Floats:
    """Places of people whom a behavior moves, each in a world of its own; no other person there reacts.

    A person starts with its last known velocity, and wants to walk as fast as it did on average while it was seen,
    whatever speed the options of the behavior name.

    Args:
        cases: The people and those around them.
        behavior: Name and options of the behavior.
        goals: (W, 2) where they want to go [m].
        radius: Radius of each person [m].

    Returns:
        (W, 12, 2) x, y [m] in the rows that follow.

    Raises:
        ArgumentError: There is no such behavior, or it does not have these options.
    """
    places = np.empty((len(cases), FORETOLD, 2))
    for part, others in cases.parts():
        wanted = np.maximum(cases.mean_speed[part], _SLOWEST)
        scenario = _scenario(others.shape[1], behavior, radius)
        simulation = Simulation(scenario, range(len(others)), threads=2)
        places[part] = _walk(simulation, others, cases.start[part], cases.velocity[part], goals[part], wanted)
    return places


def _walk(
    simulation: Simulation, others: Floats, start: Floats, velocity: Floats, goals: Floats, wanted: Floats
) -> Floats:
    """(w, 12, 2) places of the first object of each world.

    Args:
        simulation: The worlds.
        others: (w, M, 13, 2) places of the other objects [m].
        start: (w, 2) places of the first one.
        velocity: (w, 2) its velocity [m/s].
        goals: (w, 2) its goal.
        wanted: (w,) its wanted speed [m/s].
    """
    shape = (len(others), simulation.objects)
    pose, control = simulation.pose.reshape(*shape, 3), simulation.control.reshape(*shape, 3)
    command, given = simulation.command.reshape(*shape, 3), simulation.given.reshape(shape)
    named = _named_speed(simulation.scenario.objects[0].behavior)
    simulation.pace.reshape(shape)[:, 0] = wanted / named if np.isfinite(named) else 1.0
    simulation.state.vel_max.reshape(*shape, 3)[:, 0, :2] = wanted[:, None]
    simulation.state.vel_min.reshape(*shape, 3)[:, 0, :2] = -wanted[:, None]
    simulation.goal.reshape(*shape, 3)[:, 0, :2] = goals
    pose[:, 0, :2], control[:, 0, :2] = start, velocity
    places = np.empty((len(others), FORETOLD, 2))
    away = _away(shape[1] - 1)
    for row in range(FORETOLD):
        before, after = others[:, :, row], others[:, :, row + 1]
        there = np.isfinite(before + after).all(axis=2, keepdims=True)
        moving = np.where(there, (after - before) / PERIOD, 0.0)
        pose[:, 1:, :2] = np.where(there, before, away)
        control[:, 1:, :2] = moving
        for _ in range(STEPS_OF_A_ROW):
            command[:, 1:, :2] = moving
            given[:, 1:] = 1
            simulation.advance(1)
        places[:, row] = pose[:, 0, :2]
    return places


def _named_speed(behavior: Any) -> float:
    """Top speed along an axis that the options of a behavior name [m/s]; infinity without one."""
    own = behavior.top_speed_of_its_own() if isinstance(behavior, BehaviorOptions) else np.inf
    return min(float(own), *(float(getattr(behavior, key, np.inf)) for key in ("vxmax", "vymax")))


def _away(count: int) -> Floats:
    """(count, 2) places of those who are not there [m]."""
    result: Floats = _AWAY + np.stack([_APART * np.arange(count), np.zeros(count)], axis=1)
    return result


def _scenario(others: int, behavior: Mapping[str, Any], radius: float) -> ResolvedScenario:
    """A person that the behavior moves, and others that are moved from outside.

    Raises:
        ArgumentError: There is no such behavior, or it does not have these options.
    """
    half = _AWAY + _APART * (others + 1)
    body = {"kinematics": {"name": "omni"}, "shape": {"name": "circle", "radius": radius}}
    entries: list[dict[str, Any]] = [{**body, "state": [0, 0, 0], "goal": [1, 0], "behavior": dict(behavior)}]
    if others:
        top = [_FASTEST, _FASTEST]
        state = [[*place, 0.0] for place in _away(others).tolist()]
        rest = {"number": others, "state": state, "vel_max": top, "vel_min": [-speed for speed in top]}
        entries.append({**body, **rest, "goal": [None] * others})
    world = {
        "width": 2 * half,
        "height": 2 * half,
        "offset": [-half, -half],
        "step_time": PERIOD / STEPS_OF_A_ROW,
        "collision_mode": "unobstructed",
    }
    document = load_text(yaml.safe_dump({"world": world, "obstacle": entries}), name="people")
    try:
        scenario, _ = or_raise(read(document, strict=True))
    except ScenarioError as error:
        problem = next(item for item in error.diagnostics if item.severity == "error")
        key, what = (text.replace("obstacle[0].", "") for text in (format_path(problem.path), problem.message))
        fix = problem.fix or "irsim describe behaviors lists them with their options"
        raise ArgumentError(f"{key}: {what}", fix) from None
    return scenario
