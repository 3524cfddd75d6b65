"""The bridge to MuJoCo: irsim decides, MuJoCo moves robots; videos of its scene, and a report of what differs."""

from __future__ import annotations

import ctypes.util
import os
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.mujoco.mjcf import body_name
from irsim.bridges.mujoco.physics import Physics
from irsim.components.bridges.mujoco import Mujoco
from irsim.graphics.encoding.animation import ANIMATION_SUFFIXES, AnimationOptions, write_frames

if TYPE_CHECKING:
    import mujoco
import time
from collections import Counter
from collections.abc import Mapping

from irsim.bridges.base import Bridge
from irsim.bridges.mujoco.contacts import Contacts, MujocoReport, log_report, write_report
from irsim.bridges.mujoco.mjcf import choose_agents
from irsim.bridges.mujoco.rays import LidarComparison, Rays
from irsim.bridges.mujoco.robots import PUSHED
from irsim.bridges.state import Feedback, Motion, WorldState
from irsim.common.arrays import Floats
from irsim.common.extras import require
from irsim.diagnostics.diagnostic import suggestion
from irsim.simulation.scene import SceneDescription

__all__ = ["Film", "MujocoBridge", "make", "prepare_display"]

_MAX_FPS = 50.0


def prepare_display() -> None:
    """Choose how MuJoCo draws, before it is imported: without a window on Linux, unless the user has chosen."""
    if sys.platform != "linux" or os.environ.get("MUJOCO_GL") or "mujoco" in sys.modules:
        return
    for library, name in (("EGL", "egl"), ("OSMesa", "osmesa")):
        if ctypes.util.find_library(library):
            os.environ["MUJOCO_GL"] = name
            return


class Film:
    """Draws frames and writes them as a video.

    Args:
        physics: The model and its state.
        options: File, camera and size.
        step_time: Time between two frames [s].

    Raises:
        BridgeError: The file has a suffix that videos do not have, or MuJoCo cannot draw here.
    """

    def __init__(self, physics: Physics, options: Mujoco, step_time: float) -> None:
        assert options.video is not None
        self._target, self._stack = Path(options.video), ExitStack()
        if self._target.suffix.lower() not in ANIMATION_SUFFIXES:
            what = f"video: files of videos are {', '.join(ANIMATION_SUFFIXES)}; got {options.video!r}"
            raise BridgeError("bridge-mismatch", what, "video: run.mp4")
        self._physics, self._options = physics, options
        scene = physics.scene
        named = options.camera in scene.names and options.camera not in ("top", "corner")
        self._camera = f"{body_name(scene.agent(options.camera))}/camera" if named else options.camera
        self._renderer = self._drawer(options)
        fps = min(1 / step_time, _MAX_FPS)
        self._every = max(1, round(1 / step_time / fps))
        self._count = 0
        try:
            self._writer = self._stack.enter_context(write_frames(self._target, AnimationOptions(fps=fps)))
        except BaseException:
            self._renderer.close()
            raise

    def _drawer(self, options: Mujoco) -> mujoco.Renderer:
        import mujoco

        try:
            return mujoco.Renderer(self._physics.model, height=options.size[1], width=options.size[0])
        except Exception as error:
            what = f"MuJoCo cannot draw here: {error}"
            fix = "install libegl1 or libosmesa6 and set the environment variable MUJOCO_GL to egl or osmesa"
            raise BridgeError("bridge-failed", what, f"{fix}, or leave out video") from error

    def follow(self, physics: Physics) -> None:
        """Draw another model from now on."""
        self._renderer.close()
        self._physics = physics
        self._renderer = self._drawer(self._options)

    def take(self) -> None:
        """Add a frame of the present state."""
        if self._count % self._every == 0:
            import mujoco

            mujoco.mj_forward(self._physics.model, self._physics.data)
            self._renderer.update_scene(self._physics.data, camera=self._camera)
            pixels = self._renderer.render()
            opaque = np.full((*pixels.shape[:2], 1), 255, np.uint8)
            self._writer.add(np.concatenate([pixels, opaque], axis=2))
        self._count += 1

    def save(self) -> None:
        """Finish the file, which appears only now."""
        self._stack.close()

    def free(self) -> None:
        """Free what MuJoCo draws with; a second call does nothing."""
        self._renderer.close()


class MujocoBridge(Bridge):
    """Moves robots in MuJoCo.

    Args:
        options: Options of the scenario.

    Attributes:
        physics: The model and its state, from ``open`` on.
        report: Differences from irsim so far; the last report stays after ``close``.
    """

    name = "mujoco"
    peer = "MuJoCo"

    def __init__(self, options: Mujoco) -> None:
        self.options = options
        self.physics: Physics | None = None
        self._film: Film | None = None
        self._report = MujocoReport()
        self._warnings: Counter[str] = Counter()
        self._noted = False

    def open(self, scene: SceneDescription, start: WorldState) -> None:
        """Build the model, and place everything where the episode starts."""
        moved = choose_agents(scene, self.options.agents)
        if self.options.camera not in ("top", "corner", *moved):
            known = ["top", "corner", *sorted(moved)]
            fix = suggestion(self.options.camera, known, f"cameras are {', '.join(known[:20])}")
            raise BridgeError("bridge-mismatch", f"there is no camera {self.options.camera!r}", fix)
        self.agents = moved
        self._build(scene, start)
        assert self.physics is not None
        self._contacts = Contacts(self.physics)
        self._comparison = LidarComparison()
        self._noise = np.random.Generator(np.random.Philox(key=np.array([scene.seed, 0x6C696461], dtype=np.uint64)))
        self._slip: list[float] = []
        self._begun = time.perf_counter()
        self._steps = 0
        if self.options.video is not None:
            self._film = Film(self.physics, self.options, scene.step_time)
            self._film.take()

    def renew(self, scene: SceneDescription, start: WorldState) -> None:
        """Build the model of another scene; counts and the film go on."""
        assert self.physics is not None
        self._warnings.update(self.physics.warnings())
        self.agents = choose_agents(scene, self.options.agents)
        self._build(scene, start)
        self._contacts.follow(self.physics)
        if self._film is not None:
            self._film.follow(self.physics)

    def _build(self, scene: SceneDescription, start: WorldState) -> None:
        self.physics = Physics(scene, self.agents, self.options)
        self.physics.start(start.pose)
        self._rays = Rays(self.physics) if self.options.lidar != "off" else None
        self._noisy = {lidar.key for agent in scene.agents for lidar in agent.lidars if lidar.noise_std}
        self._last = start.step

    def exchange(self, motion: Motion) -> Feedback | None:
        """Advance the physics by one step; return where the robots are."""
        physics = self.physics
        assert physics is not None
        physics.advance(motion, self._contacts.watch)
        self._steps += 1
        poses, twists = physics.poses(), physics.twists()
        names = [(k, name) for k, name in enumerate(physics.rigs) if physics.rows[k] not in physics.absent]
        apart = [float(np.hypot(*(poses[k] - motion.pose[physics.rows[k]])[:2])) for k, name in names
                 if physics.rigs[name].drive != PUSHED]  # fmt: skip
        self._slip += apart
        ranges = self._measured(motion, poses) if self.options.lidar == "replace" else {}
        return Feedback(
            poses={name: tuple(poses[k].tolist()) for k, name in names},
            twists={name: tuple(twists[k].tolist()) for k, name in names},
            ranges=ranges,
        )

    def _measured(self, motion: Motion, poses: Floats) -> Mapping[str, np.ndarray]:
        """Scans of MuJoCo at the end of the step, with noise."""
        assert self.physics is not None
        assert self._rays is not None
        pose = motion.pose.copy()
        for k, row in enumerate(self.physics.rows):
            if row not in self.physics.absent:
                pose[row] = poses[k]
        self.physics.place(pose)
        scans = self._rays.scan(pose)
        if self.options.range_noise:
            for key, beams in scans.items():
                noise = self._noise.standard_normal(len(beams)) * self.options.range_noise
                scans[key] = np.maximum(beams + noise, 0.0).astype(np.float32)
        return scans

    def push(self, state: WorldState) -> None:
        """Place what irsim has moved, and compare the lidars of both simulators."""
        physics = self.physics
        assert physics is not None
        if state.step < self._last:
            physics.start(state.pose)  # another episode
        else:
            physics.place(state.pose)
        self._last = state.step
        if self._rays is not None and self.options.lidar == "compare":
            ours = {key: beams for key, beams in state.ranges.items() if key not in self._noisy}
            with physics.upright():
                self._comparison.add(ours, self._rays.scan(state.pose))
        if self._film is not None:
            self._film.take()

    @property
    def report(self) -> MujocoReport:
        """The differences from irsim so far."""
        if self.physics is None:
            return self._report
        slip = np.array(self._slip) if self._slip else np.zeros(1)
        comparison = self._comparison
        return MujocoReport(
            steps=self._steps,
            simulated_s=self._steps * self.physics.scene.step_time,
            wall_s=time.perf_counter() - self._begun,
            objects=sorted(self.agents),
            contacts=self._contacts.count,
            ghost_contacts=self._contacts.ghosts,
            first_contacts=[vars(contact) for contact in self._contacts.begins],
            step_difference_median_m=float(np.median(slip)),
            step_difference_largest_m=float(slip.max()),
            lidar_beams=comparison.beams,
            lidar_one_sided=comparison.one_sided,
            lidar_median_m=comparison.quantile(0.5),
            lidar_p99_m=comparison.quantile(0.99),
            lidar_largest_m=comparison.largest,
            warnings=dict(self._warnings + Counter(self.physics.warnings())),
        )

    def notes(self) -> list[str]:
        """The main numbers of the report."""
        self._noted = self._steps > 0
        return self.report.lines() if self._noted else []

    def close(self) -> None:
        """Finish the video and report; a second call does nothing."""
        film, self._film = self._film, None
        if self.physics is None:
            if film is not None:
                film.free()
            return
        self._report = self.report
        self.physics = None
        try:
            if film is not None:
                film.save()
        finally:
            if film is not None:
                film.free()
            if self._report.steps:
                if not self._noted:
                    log_report(self._report)
                if self.options.report is not None:
                    write_report(self._report, Path(self.options.report))


def make(options: Mujoco) -> MujocoBridge:
    """The bridge of some options.

    Raises:
        ExtraError: MuJoCo is not installed.
        BridgeError: A file has a suffix that its content does not fit.
    """
    require("mujoco", "mujoco")
    if options.video is not None:
        prepare_display()
    return MujocoBridge(options)
