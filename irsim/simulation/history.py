"""The past of an environment: where its objects were and what their goals were at the end of every step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from irsim.common.arrays import Floats
from irsim.simulation.build import steps_within

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["all_poses", "past_goals", "past_poses"]


def past_poses(simulation: Simulation, row: int) -> Floats | None:
    """Return the (T + 1, 3) poses of an object at the start and after each of T steps.

    Args:
        simulation: A simulation with a single world, made with history.
        row: Row of the object.

    Returns:
        x, y [m] and heading [rad], world frame, NaN before its ``appear_time`` and after
        it has left the world; None if a script added the object, or
        has interfered with its history.
    """
    state, steps = simulation.state, int(simulation.count[0])
    start = state.initial_state(row)[None, :3]
    appeared = int(simulation.appeared[row])
    gone, appeared = appeared < -1, appeared if appeared >= -1 else -2 - appeared
    begin = appeared if appeared >= 0 else steps + 1  # it records no state before
    absent = np.array([[np.nan, np.nan, start[0, 2]]])
    if simulation.scenario.objects[row].static:
        return np.concatenate([np.repeat(absent, begin, axis=0), np.repeat(start, steps + 1 - begin, axis=0)])
    since, _, stopped = state.standings(row)
    if not len(since) or since[0] != 0:
        return None
    held = np.repeat(stopped.astype(bool), np.diff([*since, steps + 1]))[:-1]  # a stopped object records no state
    held[: max(0, begin - 1)] = True
    end = _last_step(simulation, row) if gone else steps
    held[end:] = True
    track = np.concatenate([absent if begin else start, state.trajectory(row)[:, :3]])
    last = np.concatenate([[0], np.cumsum(~held)])
    if last[-1] != len(track) - 1:
        return None
    poses: Floats = track[last]
    poses[end + 1 :, :2] = np.nan
    return poses


def _last_step(simulation: Simulation, row: int) -> int:
    """Return the last step in which an object that has left the world was in it."""
    until = simulation.scenario.objects[row].vanish_time or 0.0
    return steps_within(until, simulation.scenario.world.step_time)


def past_goals(simulation: Simulation, row: int) -> Floats | None:
    """Return the (T + 1, 3) goals of an object at the start and after each of T steps, with NaN for missing numbers.

    See :func:`past_poses`; None also for objects that never move.
    """
    since, goals, _ = simulation.state.standings(row)
    if not len(since) or since[0] != 0:
        return None
    return np.repeat(goals, np.diff([*since, int(simulation.count[0]) + 1]), axis=0)


def all_poses(simulation: Simulation) -> Floats | None:
    """Return the (T + 1, N, 3) poses of all objects; None if :func:`past_poses` does not know those of one of them."""
    found = [past_poses(simulation, row) for row in range(simulation.objects)]
    known = [poses for poses in found if poses is not None]
    return np.stack(known, axis=1) if known and len(known) == len(found) else None
