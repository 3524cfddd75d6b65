"""Evaluates built-in behaviors for arrays, in small worlds made for one call."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from pydantic import BaseModel

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.options.registry import BEHAVIORS, KINEMATICS, SHAPES
from irsim.scenario.read import or_raise, read
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario
from irsim.simulation.build import build_world

__all__ = ["Agent", "behavior_options", "dash", "decide"]

PADDING = 0.1
"""Margin [m] that IR-SIM adds to the radii that avoidance laws use."""
GOAL_DISTANCE = 100.0
"""Distance [m] at which a goal is placed in the direction of a desired velocity."""
MIN_RADIUS = 1e-9
"""Smallest radius [m] of a circle that stands for an agent."""
_STEP_TIME = 0.1
"""Default period [s]."""
ANGLE_TOLERANCE = 0.1
"""Default heading error [rad] below which ``dash`` does not correct the heading."""


@cache
def _base() -> ResolvedScenario:
    entry = {"kinematics": {"name": "omni"}, "shape": {"name": "circle"}, "state": [0, 0, 0], "goal": [1, 0]}
    line = {"shape": {"name": "linestring", "vertices": [[0, 0], [1, 0]]}, "state": [0, 0, 0]}
    scenario, _ = or_raise(read({"world": {"collision_mode": "unobstructed"}, "robot": entry, "obstacle": line}))
    return scenario


def behavior_options(name: str, keys: Mapping[str, Any]) -> BaseModel:
    """Return the options of a built-in behavior from the keys that it takes; other keys are ignored.

    Raises:
        LookupError: No built-in behavior has the name.
        ValidationError: A value is not valid.
    """
    feature = BEHAVIORS.get(name)
    if feature is None or feature.kernel is None:
        raise LookupError(f"{name!r} is not a built-in behavior")
    known = {key: value for key, value in keys.items() if key in feature.options.model_fields and key != "name"}
    return feature.options.model_validate({**known, "name": name})


class Agent:
    """An object as avoidance laws see it, in the world frame.

    Args:
        numbers: x, y [m], vx, vy [m/s], padded radius [m]; for an agent that decides also its desired vx, vy [m/s].
    """

    def __init__(self, numbers: Sequence[float]) -> None:
        values = [float(value) for value in numbers]
        self.x, self.y, self.vx, self.vy, self.radius = values[:5]
        self.wanted = values[5:7]

    def record(self, number: int, options: BaseModel | None, *, grouped: bool) -> ObjectRecord:
        """Return the scenario record of the agent as an object with a holonomic drive.

        Args:
            number: Id of the object.
            options: Behavior of an agent that decides; None for other agents.
            grouped: Whether the behavior belongs to the group.
        """
        speed = math.hypot(*self.wanted) if self.wanted else 0.0
        goals = []
        if speed > 0:
            goals = [[self.x + GOAL_DISTANCE * self.wanted[0] / speed, self.y + GOAL_DISTANCE * self.wanted[1] / speed]]
        circle = SHAPES.get("circle")
        assert circle is not None
        return replace(
            _base().objects[0],
            id=number,
            name=str(number),
            group=0 if options is not None else number + 1,
            state=[self.x, self.y, 0.0],
            velocity=[self.vx, self.vy],
            vel_min=[-speed, -speed],
            vel_max=[speed, speed],
            goals=goals,
            shape=circle.options.model_validate({"radius": max(self.radius - PADDING, MIN_RADIUS)}),
            behavior=None if grouped else options,
            group_behavior=options if grouped else None,
        )


def decide(
    options: BaseModel,
    agents: Sequence[Sequence[float]],
    discs: Sequence[Sequence[float]] | None,
    lines: Sequence[Sequence[float]] | None,
    *,
    grouped: bool = False,
    step_time: float = _STEP_TIME,
) -> Floats:
    """Return the world-frame velocities that a behavior chooses for agents, (K, 2) [m/s].

    Args:
        options: Options of the behavior.
        agents: [x, y, vx, vy, padded radius, desired vx, desired vy, …] of each agent that decides.
        discs: [x, y, vx, vy, padded radius] of each other object.
        lines: [x1, y1, x2, y2] of each line segment.
        grouped: Whether the agents are one group.
        step_time: Period [s].
    """
    records = [Agent(numbers).record(k, options, grouped=grouped) for k, numbers in enumerate(agents)]
    records += [
        Agent(numbers[:5]).record(len(records) + k, None, grouped=False) for k, numbers in enumerate(discs or ())
    ]
    records += [_line(len(records) + k, numbers) for k, numbers in enumerate(lines or ())]
    base = _base()
    timed = base.world.model_copy(update={"step_time": float(step_time)})
    world = build_world(replace(base, world=timed, objects=records))
    state = core.State(world, np.zeros(1, dtype=np.uint64), False)
    core.decide(world, state)
    return state.command[: len(agents), :2].copy()


def _line(number: int, numbers: Sequence[float]) -> ObjectRecord:
    x1, y1, x2, y2 = (float(value) for value in numbers)
    line = SHAPES.get("linestring")
    assert line is not None
    shape = line.options.model_validate({"name": "linestring", "vertices": [[x1, y1], [x2, y2]]})
    return replace(_base().objects[1], id=number, name=str(number), group=number + 1, shape=shape)


def dash(
    drive: str,
    state: Floats,
    goal: Floats,
    vel_max: Floats,
    goal_threshold: float,
    angle_tolerance: float = ANGLE_TOLERANCE,
    turning_acce: float = math.inf,
    dt: float = 0.0,
) -> Floats:
    """Return the control that drives an object with a built-in drive straight to its goal, (n, 1).

    Args:
        drive: Name of the kinematics.
        state: State (3 or more, 1): x, y [m], heading [rad], extra rows.
        goal: Goal (2 or 3, 1): x, y [m], heading [rad].
        vel_max: Upper limits of the control, (n, 1).
        goal_threshold: Distance to the goal below which the object has arrived [m].
        angle_tolerance: Heading error below which the heading is not corrected [rad].
        turning_acce: Limit on the change of the turning control [rad/s^2].
        dt: Period [s], which a finite ``turning_acce`` requires.
    """
    numbers = np.asarray(state, dtype=np.float64).reshape(-1).tolist()
    top = np.asarray(vel_max, dtype=np.float64).reshape(-1).tolist()
    feature = KINEMATICS.get(drive)
    assert feature is not None
    record = replace(
        _base().objects[0],
        kinematics=feature.options.model_validate({"name": drive}),
        state=numbers,
        goals=[np.asarray(goal, dtype=np.float64).reshape(-1)[:3].tolist()],
        vel_max=top,
        vel_min=[-value for value in top],
        acce=[*[math.inf] * (len(top) - 1), turning_acce],
        velocity=[0.0] * len(top),
        goal_threshold=goal_threshold,
        behavior=behavior_options("dash", {"angle_tolerance": angle_tolerance}),
    )
    timed = _base().world.model_copy(update={"step_time": dt if dt > 0 else _STEP_TIME})
    world = build_world(replace(_base(), world=timed, objects=[record]))
    made = core.State(world, np.zeros(1, dtype=np.uint64), False)
    core.decide_row(world, made, 0)
    return made.command[0, : len(top), None].copy()
