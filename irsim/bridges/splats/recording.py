"""A recorded run among splats: bodies of its objects, their poses, and where the scene is."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.export.cameras import PoseOptions, Scene, scene_of
from irsim.bridges.recorded import recorded_scene, recorded_states
from irsim.bridges.splats.bodies import Body, body_of
from irsim.common.arrays import Floats
from irsim.runs.reading import Run, open_run
from irsim.scenario.limits import Limits
from irsim.simulation.scene import SceneDescription

__all__ = ["Recording", "open_recording"]


@dataclass(frozen=True)
class Recording:
    """What a picture of a run shows.

    Attributes:
        run: The run.
        scene: The scene of the run.
        world: Where the splats are.
        bodies: Objects that are shown.
        step: (T,) steps.
        time: (T,) simulated times [s].
        pose: (T, B, 3) x, y [m], yaw [rad] of the bodies, frame of irsim.
    """

    run: Run
    scene: SceneDescription
    world: Scene
    bodies: tuple[Body, ...]
    step: np.ndarray[tuple[int], np.dtype[np.int64]]
    time: Floats
    pose: Floats

    def index_of(self, name: str | None) -> int:
        """Number of a robot among the bodies; without a name, of the first one.

        Raises:
            BridgeError: There is no such robot.
        """
        robots = [number for number, body in enumerate(self.bodies) if body.role == "robot"]
        for number in robots:
            if name in (None, self.bodies[number].name):
                return number
        known = ", ".join(self.bodies[number].name for number in robots[:8])
        known += f" and {len(robots) - 8} more" * (len(robots) > 8)
        what = f"run {self.run.id} has no robot {name!r}" if name is not None else f"run {self.run.id} has no robot"
        raise BridgeError("bridge-mismatch", what, f"its robots are {known}" if robots else "record one with a robot")


def open_recording(
    run: str | Path | Run,
    options: PoseOptions,
    *,
    every: int,
    workspace: str | Path | None = None,
    limits: Limits | None = None,
) -> Recording:
    """Read a run for pictures.

    Args:
        run: Id of the run, its folder, or ``last``.
        options: Where the scene is.
        every: Read every such step, and the last one.
        workspace: Folder whose ``.irsim/runs`` holds the run.
        limits: Limits of the reader of the scenario.

    Raises:
        RunError: There is no such run, or it cannot be read.
        BridgeError: The sidecar of the map cannot be used.
    """
    opened = run if isinstance(run, Run) else open_run(run, workspace)
    scene = recorded_scene(opened, limits)
    found = [(number, body) for number, agent in enumerate(scene.agents) if (body := body_of(agent)) is not None]
    rows = [number for number, _ in found]
    steps, times, poses = [], [], []
    for state in recorded_states(opened, every, limits):
        steps.append(state.step)
        times.append(state.time)
        poses.append(state.pose[rows])
    return Recording(
        opened,
        scene,
        scene_of(opened, options, limits, "irsim"),
        tuple(body for _, body in found),
        np.array(steps, dtype=np.int64),
        np.array(times),
        np.array(poses).reshape(len(steps), len(rows), 3),
    )
