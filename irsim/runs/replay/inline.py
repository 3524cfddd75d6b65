"""The replay page inside a notebook: ``result.replay()`` and ``env.replay()``."""

from __future__ import annotations

import copy
from typing import Any

from irsim.common.installed import version
from irsim.common.log import LEVELS
from irsim.common.notebook import Page
from irsim.common.text import clean, seconds
from irsim.diagnostics.errors import InputError
from irsim.runs.reading import Run
from irsim.runs.replay.data import Packed, pack_run, pack_trace
from irsim.runs.replay.page import page
from irsim.simulation.trace import all_poses, join_traces, past_goals, present_row

__all__ = ["replay_of_env", "replay_of_run"]

HEIGHT_PX = 640


def replay_of_run(run: Run, height: int = HEIGHT_PX) -> Page:
    """The replay of a recorded run.

    Args:
        run: The run.
        height: Height in the notebook [px].
    """
    return _page(pack_run(run), height)


def replay_of_env(env: Any, height: int = HEIGHT_PX) -> Page:
    """The replay of the present episode of an environment, from its start to the present step.

    A copy of the environment is moved as the objects moved, so that the page has its contacts and scans.

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
    goals = [past_goals(simulation, row) for row in range(simulation.objects)]
    twin = copy.deepcopy(env)
    twin.logger.level = LEVELS["CRITICAL"]
    try:
        twin.reset()
        rows = [present_row(twin.simulation, scans=True)]
        for pose in poses[1:]:
            twin.simulation.pose[:] = pose
            twin.simulation.step_external()
            rows.append(present_row(twin.simulation, scans=True))
        trace = join_traces(rows)
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
            "notes": [],
        }
        return _page(pack_trace(trace, env.events, twin.simulation, about), height)
    finally:
        twin.end(ending_time=0.0)


def _page(packed: Packed, height: int) -> Page:
    title = clean(packed.head["title"])
    about = f"Replay of {title}: {packed.head['last_step']} steps"
    return Page(page(packed.data, title=f"{title} · irsim replay"), about, height)
