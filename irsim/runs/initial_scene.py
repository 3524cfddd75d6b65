"""The scene of a recorded run at its start, with the shapes that the recording lacks."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from irsim.env import Env
from irsim.runs.files import RunError
from irsim.runs.reading import Run
from irsim.runs.resimulation import scenario_of
from irsim.scenario.limits import Limits

__all__ = ["initial_scene"]


@contextmanager
def initial_scene(run: Run, limits: Limits | None = None) -> Iterator[Env]:
    """Context with an environment at the start of a run, whose shapes and map can be read.

    Args:
        run: The recorded run.
        limits: Limits of the reader of its scenario.

    Raises:
        RunError: The scenario now has other initial poses, because a map or irsim itself has changed.
        ScenarioError: The scenario has errors, for example because another file of it has changed.
    """
    recorded = next(run.blocks(1, scans=False)).pose[0]
    env = Env(scenario_of(run, limits), seed=int(run.meta["seed"]), headless=True, log_level="ERROR")
    try:
        start = env.simulation.pose
        if recorded.shape != start.shape or not np.array_equal(recorded, start, equal_nan=True):
            what = f"the scenario of run {run.id} now has other initial poses"
            raise RunError("unreadable-run", what, "a map or the version of irsim has changed since: run it again")
        yield env
    finally:
        env.end(ending_time=0.0)
