"""A recorded run as scene and states of bridges."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from irsim.bridges.state import WorldState
from irsim.common.angles import wrap
from irsim.objects.describe import agent_rows, describe_scene
from irsim.runs.reading import Run
from irsim.runs.resimulation import initial_scene
from irsim.scenario.limits import Limits
from irsim.simulation.scene import SceneDescription

__all__ = ["recorded_scene", "recorded_states"]

_ROWS = 1000
"""Rows of a run that are in memory at a time."""


def recorded_scene(run: Run, limits: Limits | None = None) -> SceneDescription:
    """The scene of a recorded run at its start.

    Args:
        run: The run.
        limits: Limits of the reader of its scenario.

    Raises:
        RunError: The scenario now has other initial poses.
        ScenarioError: The scenario has errors now.
    """
    with initial_scene(run, limits) as env:
        scene = describe_scene(env.simulation)
    return replace(scene, about={**scene.about, "run": run.id})


def recorded_states(run: Run, every: int = 1, limits: Limits | None = None) -> Iterator[WorldState]:
    """Yield the states of a recorded run, with rows as in :func:`recorded_scene`.

    Twists are mean velocities during the step that led to a state; they are zero at the start. Paths were not recorded.

    Args:
        run: The run.
        every: Yield every such state, and the last one.
        limits: Limits of the reader of its scenario.

    Raises:
        RunError: A file of the run has been changed, or no step was recorded.
    """
    with initial_scene(run, limits) as env:
        rows = agent_rows(env.simulation)
    before, last = None, run.last_step
    for trace in run.blocks(_ROWS):
        pose = trace.pose[:, rows]
        led = np.concatenate([pose[:1] if before is None else before, pose[:-1]])
        twist = (pose - led) / trace.step_time
        twist[:, :, 2] = wrap(pose[:, :, 2] - led[:, :, 2]) / trace.step_time
        before = pose[-1:].copy()
        for row, step in enumerate(trace.step.tolist()):
            if step % every and step != last:
                continue
            yield WorldState(
                step=int(step),
                time=float(trace.time[row]),
                pose=pose[row].copy(),
                twist=np.nan_to_num(twist[row]),
                control=trace.control[row, rows].copy(),
                goal=trace.goal[row, rows].copy(),
                arrived=trace.arrived[row, rows].copy(),
                collided=trace.collided[row, rows].copy(),
                stopped=trace.stopped[row, rows].copy(),
                ranges={key: block[row] for key, block in trace.ranges.items() if row < len(block)},
                readings={key: block[row] for key, block in trace.readings.items() if row < len(block)},
            )
