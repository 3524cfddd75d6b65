"""Robots that drove to and fro at their goal, and robots that came as near to something as they could."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from irsim.common.text import metres, quoted, seconds

if TYPE_CHECKING:
    from irsim.env import Env
    from irsim.results.run import RobotResult

__all__ = ["closeness_message", "shunting_message"]

_NEAR = 1.0
"""A car that came within this distance of its goal should soon be there [m]."""
_MIN_TIME = 5.0
"""Time from then on that is worth a word [s]."""
_CLOSE = 5e-3
"""Distances below this are shown as 0.00 [m]."""


def shunting_message(env: Env, robots: Sequence[RobotResult], parked: Sequence[str]) -> str | None:
    """Which car was long near its last goal before it arrived, and how far it drove in all; None if none was."""
    found: list[str] = []
    for view, robot in zip(env.robot_list, robots, strict=True):
        goal, record = view.goal, view.record
        if goal is None or robot.name in parked or record.wander or record.loop:
            continue
        if getattr(record.kinematics, "name", "") != "acker":
            continue
        state, arrived = env.simulation.state, robot.time_to_goal
        steps = int(env.simulation.count[0]) if arrived is None else round(arrived / env.step_time)
        track = np.vstack([state.initial_state(view.row)[None, :2], state.trajectory(view.row)[:, :2]])[: steps + 1]
        away = np.hypot(*(track - goal[:2, 0]).T)
        near = np.flatnonzero(away < _NEAR)
        if not near.size:
            continue
        first = int(near[0])
        lengths = np.hypot(*np.diff(track, axis=0).T)
        driven, moved = float(lengths.sum()), float(lengths[first:].sum())
        time = (len(track) - 1 - first) * env.step_time
        if moved < 3 * _NEAR or time < _MIN_TIME:
            continue
        least = "" if arrived is not None else f", no nearer than {metres(float(away.min()))}"
        found.append(
            f"{quoted(robot.name)} drove {metres(driven)} of a {metres(driven - moved + float(away[first]))} way, "
            f"{seconds(time)} of it to and fro at the goal{least}"
        )
    if not found:
        return None
    more = f" and {len(found) - 1} more likewise" if len(found) > 1 else ""
    return f"{found[0]}{more} (raise goal_threshold)"


def closeness_message(robots: Sequence[RobotResult]) -> str | None:
    """Which robot came within 0 m of something but did not touch it; None if none did."""
    names = [
        (robot.name, robot.nearest_called)
        for robot in robots
        if robot.min_clearance is not None
        and 0 <= robot.min_clearance < _CLOSE
        and robot.collision_count == robot.contacts_between_steps == 0
    ]
    if not names:
        return None
    (name, other), more = names[0], len(names) - 1
    others = f" and {more} more robot{'s' * (more > 1)}" if more else ""
    beside = f" {other}" if other else " something"
    return f"{quoted(name)}{others} came within 5 mm of{beside} without touching: that is no collision"
