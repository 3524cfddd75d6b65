"""The bridge to MuJoCo: irsim decides, MuJoCo moves robots, and what differs between both is reported."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from irsim.bridges.base import Bridge, BridgeError
from irsim.bridges.mujoco.contacts import Contacts, MujocoReport, log_report, write_report
from irsim.bridges.mujoco.mjcf import choose_agents
from irsim.bridges.mujoco.physics import Physics
from irsim.bridges.mujoco.rays import LidarComparison, Rays
from irsim.bridges.mujoco.robots import PUSHED
from irsim.bridges.mujoco.video import Film, prepare_display
from irsim.bridges.state import Feedback, Motion, WorldState
from irsim.common.arrays import Floats
from irsim.common.extras import require
from irsim.components.bridges.mujoco import Mujoco
from irsim.diagnostics.diagnostic import suggestion
from irsim.simulation.scene import SceneDescription

__all__ = ["MujocoBridge", "make"]


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
        self._noisy = {lidar.key for agent in scene.agents for lidar in agent.lidars if lidar.noise}
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
