"""The replay page inside a notebook: ``result.replay()`` and ``env.replay()``."""

from __future__ import annotations

import copy
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.angles import wrap
from irsim.common.arrays import Floats
from irsim.common.installed import version
from irsim.common.log import LEVELS
from irsim.common.notebook import Page
from irsim.common.text import clean, listed, seconds
from irsim.diagnostics.errors import InputError
from irsim.runs.reading import Run
from irsim.runs.replay.beliefs import believers_of
from irsim.runs.replay.data import Packed, pack_run, pack_trace
from irsim.runs.replay.page import page
from irsim.simulation.trace import Trace, all_poses, join_traces, past_goals, present_readings, present_row

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["replay_of_env", "replay_of_run"]

HEIGHT_PX = 640
_TOLERANCE_M = 1e-3
"""Readings that differ less look the same [m]; between two poses of a step velocities are known only on the mean."""


def replay_of_run(run: Run, height: int = HEIGHT_PX) -> Page:
    """The replay of a recorded run.

    Args:
        run: The run.
        height: Height in the notebook [px].
    """
    return _page(pack_run(run), height)


def replay_of_env(env: Any, height: int = HEIGHT_PX) -> Page:
    """The replay of the present episode of an environment, from its start to the present step.

    A copy of the environment is moved as the objects moved, with the noise of this episode, so that the page has its
    contacts, scans, beliefs and tracks. Sensors whose last reading in the copy differs from the environment, such as
    odometry after wheels have slipped, are left out, and the page says so.

    Args:
        env: The environment.
        height: Height in the notebook [px].

    Raises:
        InputError: Objects were added or deleted, or the environment cannot be copied.
    """
    simulation = env.simulation
    poses = all_poses(simulation)
    if poses is None:
        what = "the past of this episode is not known: the script added or deleted objects, or the world is empty"
        raise InputError(what, "call env.reset() first, or put the objects into the scenario")
    step_time = float(simulation.scenario.world.step_time)
    goals = [past_goals(simulation, row) for row in range(simulation.objects)]
    twin = copy.deepcopy(env)
    twin.logger.level = LEVELS["CRITICAL"]
    try:
        twin.simulation.state.noise[:] = simulation.state.noise - np.uint32(1)  # the reset counts it up again
        twin.reset()
        rows = [_seen(twin.simulation)]
        for before, pose in pairwise(poses):
            twin.simulation.pose[:] = pose
            twin.simulation.twist[:] = _twist(before, pose, step_time=step_time)
            twin.simulation.step_external()
            rows.append(_seen(twin.simulation))
        trace, notes = _as_reported(join_traces(rows), simulation)
        for number, goal in enumerate(goals):
            if goal is not None:
                trace.goal[:, number] = goal
        trace.pose[:] = poses
        twin.reset()
        about = {
            "run_id": "",
            "title": clean(simulation.scenario.name),
            "status": env.outcome,
            "outcome": None if env.outcome == "running" else env.outcome,
            "summary": f"after {seconds(env.time)}",
            "reason": None,
            "seed": env.seed,
            "irsim": version(),
            "notes": notes,
        }
        return _page(pack_trace(trace, env.events, twin.simulation, about), height)
    finally:
        twin.end(ending_time=0.0)


def _seen(simulation: Simulation) -> Trace:
    """The present state, with everything that sensors report."""
    return replace(present_row(simulation, scans=True), readings=present_readings(simulation))


def _twist(before: Floats, pose: Floats, *, step_time: float) -> Floats:
    """(N, 3) mean velocities [m/s] and turn rates [rad/s] between two poses; 0 for what is not in the world."""
    by = pose - before
    by[:, 2] = wrap(by[:, 2])
    return np.nan_to_num(by) / step_time


def _as_reported(trace: Trace, simulation: Simulation) -> tuple[Trace, list[str]]:
    """The trace of a copy without readings that end differently in the simulation, and a note that names their sensors.

    Poses and tracks are compared by the numbers that the page shows.
    """
    believers, now = believers_of(simulation), present_readings(simulation)
    needed = {*believers.estimates.values(), *(key for _, key in believers.detectors)}
    readings = {key: block for key, block in trace.readings.items() if key in needed}
    odd = [key for key, block in readings.items() if not _same(block[-1], now[key][0])]
    note = f"what {listed([repr(key) for key in odd], 3)} reported is not shown: the replay cannot compute it again"
    kept = {key: block for key, block in readings.items() if key not in odd}
    return replace(trace, readings=kept), [note] if odd else []


def _same(one: NDArray[np.void], other: NDArray[np.void]) -> bool:
    names = [name for name in ("id", "x", "y", "theta", "object") if name in (other.dtype.names or ())]
    return all(np.allclose(one[name], other[name], rtol=0, atol=_TOLERANCE_M, equal_nan=True) for name in names)


def _page(packed: Packed, height: int) -> Page:
    title = clean(packed.head["title"])
    about = f"Replay of {title}: {packed.head['last_step']} steps"
    return Page(page(packed.data, title=f"{title} · irsim replay"), about, height)
