"""A model in MuJoCo that is advanced step by step beside irsim."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.frames import quaternion_of, rotation_of
from irsim.bridges.mujoco.mjcf import PARKED, body_name, is_mocap, rigs_of, write_mjcf
from irsim.bridges.mujoco.robots import PLANAR, TURNING, Driver
from irsim.bridges.state import Motion
from irsim.common.angles import wrap
from irsim.common.arrays import Floats
from irsim.components.bridges.mujoco import Mujoco
from irsim.simulation.scene import SceneDescription

if TYPE_CHECKING:
    import mujoco

__all__ = ["Physics"]


_SETTLING_S = 0.2
"""Time in which robots come to rest on their wheels before the start [s]."""
_MOVED = 1e-6
"""Distance from which a robot counts as placed elsewhere by irsim [m, rad]."""
_PUSHED = 0.05
"""Distance up to which it keeps its velocity, because contacts of irsim have pushed it [m, rad]."""


class Physics:
    """The model of a scene and its state.

    Args:
        scene: The scene.
        moved: Names of the robots that MuJoCo moves.
        options: Physics.

    Raises:
        BridgeError: MuJoCo does not accept the model.
    """

    def __init__(self, scene: SceneDescription, moved: frozenset[str], options: Mujoco) -> None:
        import mujoco

        self.scene, self.options = scene, options
        try:
            self.model: mujoco.MjModel = mujoco.MjModel.from_xml_string(write_mjcf(scene, moved, options))
        except ValueError as error:
            what = f"MuJoCo does not accept the scene: {error}"
            raise BridgeError("bridge-failed", what, "look at `irsim export --to mjcf`") from None
        self.data: mujoco.MjData = mujoco.MjData(self.model)
        self._step, self._kinematics = mujoco.mj_step, mujoco.mj_kinematics
        self.rigs = rigs_of(scene, moved, options)
        self.rows = tuple(scene.agent(name).index for name in self.rigs)
        self.bodies = {name: self.model.body(body_name(scene.agent(name))).id for name in self.rigs}
        random = np.random.Generator(np.random.Philox(key=np.array([scene.seed, 0x6D756A6F], dtype=np.uint64)))
        self.driver = Driver(tuple(self.rigs), self.rows, tuple(self.rigs.values()), options, random)
        self.count = max(1, round(scene.step_time / self.model.opt.timestep))
        """Periods of the physics in a step of irsim."""
        self._actuators()
        self._mocaps(moved)
        self.absent: set[int] = set()
        """Rows of robots that are not in the world."""

    def _actuators(self) -> None:
        """Where targets go: actuators in the order of targets, and the rows that are turned into the world frame."""
        ids: list[int] = []
        planar: list[tuple[int, int]] = []  # first target, row of the robot
        for robot, name in enumerate(self.rigs):
            if self.rigs[name].drive in ("omni", "omni_angular"):
                planar.append((len(ids), robot))
            body = body_name(self.scene.agent(name))
            ids += [self.model.actuator(f"{body}/{suffix}").id for suffix in self.driver.targets_at(robot)]
        self._actuator = np.array(ids, dtype=np.intp)
        self._planar_first = np.array([first for first, _ in planar], dtype=np.intp)
        self._planar_body = np.array([list(self.bodies.values())[robot] for _, robot in planar], dtype=np.intp)

    def _mocaps(self, moved: frozenset[str]) -> None:
        agents = [agent for agent in self.scene.agents if is_mocap(agent, moved)]
        self._mocap_rows = np.array([agent.index for agent in agents], dtype=np.intp)
        ids = [int(self.model.body(body_name(agent)).mocapid[0]) for agent in agents]
        self._mocap_ids = np.array(ids, dtype=np.intp)
        self._mocap_pose = np.array([agent.pose for agent in agents], dtype=np.float64).reshape(-1, 3)

    # poses ------------------------------------------------------------------------------------------------------------
    def start(self, pose: Floats) -> None:
        """Place everything at the start of an episode, and let the robots come to rest on their wheels."""
        self.driver.forget()
        self.absent.clear()
        self.place(pose)
        if self.rigs:
            self.data.ctrl[:] = 0.0
            with _without_log():
                for _ in range(int(np.ceil(_SETTLING_S / self.model.opt.timestep))):
                    self._step(self.model, self.data)
        self.data.time = 0.0
        self.place(pose)

    def place(self, pose: Floats) -> None:
        """Place objects where irsim has them: objects that it moves, and robots that it has put elsewhere.

        Args:
            pose: (N, 3) of all objects; NaN for objects that are not in the world.
        """
        self._show_mocaps(pose[self._mocap_rows])
        self._mocap_pose = pose[self._mocap_rows].copy()
        present = self.poses()
        for k, (name, row) in enumerate(zip(self.rigs, self.rows, strict=True)):
            if np.isnan(pose[row]).any():
                if row not in self.absent:
                    self.absent.add(row)
                    self._put(name, (PARKED * (k + 1), PARKED, 0.0), stop=True)
                continue
            apart = pose[row] - present[k]
            apart[2] = 0.0 if self.rigs[name].drive == "omni" else wrap(apart[2])
            far = float(np.abs(apart).max())
            if row in self.absent or far > _MOVED:
                self._put(name, tuple(pose[row].tolist()), stop=row in self.absent or far > _PUSHED)
                self.absent.discard(row)
        self._kinematics(self.model, self.data)

    def _show_mocaps(self, pose: Floats) -> None:
        gone = ~np.isfinite(pose.sum(axis=1))
        shown = np.where(gone[:, None], 0.0, pose)
        self.data.mocap_pos[self._mocap_ids, :2] = shown[:, :2]
        self.data.mocap_pos[self._mocap_ids, 2] = np.where(gone, PARKED, 0.0)
        self.data.mocap_quat[self._mocap_ids] = np.roll(quaternion_of(rotation_of(shown[:, 2])), 1, axis=1)

    def _put(self, name: str, pose: tuple[float, ...], *, stop: bool) -> None:
        """Place a robot, at rest if ``stop``; one with wheels keeps its height."""
        model, data, body = self.model, self.data, self.bodies[name]
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        speed = int(model.jnt_dofadr[first])
        address = int(model.jnt_qposadr[first])
        if self.rigs[name].drive in PLANAR:
            data.qpos[address : address + count] = pose[:count]
            data.qvel[speed : speed + count] *= not stop
            return
        data.qpos[address : address + 2] = pose[:2]
        data.qpos[address + 3 : address + 7] = np.roll(quaternion_of(rotation_of(pose[2])), 1)
        if not stop:
            return
        data.qvel[speed : speed + 6] = 0.0
        for wheel in range(body + 1, model.nbody):
            if model.body_rootid[wheel] != body:
                break
            for joint in range(model.body_jntadr[wheel], model.body_jntadr[wheel] + model.body_jntnum[wheel]):
                data.qvel[model.jnt_dofadr[joint]] = 0.0

    @contextmanager
    def upright(self) -> Iterator[None]:
        """Context in which robots on wheels stand upright, as in irsim; else they pitch by up to half a degree."""
        qpos = self.data.qpos.copy()
        for (name, body), pose in zip(self.bodies.items(), self.poses(), strict=True):
            if self.rigs[name].drive not in PLANAR:
                address = int(self.model.jnt_qposadr[self.model.body_jntadr[body]])
                self.data.qpos[address + 3 : address + 7] = np.roll(quaternion_of(rotation_of(pose[2])), 1)
        self._kinematics(self.model, self.data)
        try:
            yield
        finally:
            self.data.qpos[:] = qpos
            self._kinematics(self.model, self.data)

    def poses(self) -> Floats:
        """(K, 3) x, y [m], yaw [rad] of the robots that MuJoCo moves, world frame."""
        result = np.empty((len(self.rigs), 3))
        for k, (name, body) in enumerate(self.bodies.items()):
            address = int(self.model.jnt_qposadr[self.model.body_jntadr[body]])
            result[k, :2] = self.data.qpos[address : address + 2]
            if self.rigs[name].drive in TURNING:
                result[k, 2] = wrap(self.data.qpos[address + 2])
            elif self.rigs[name].drive == "omni":
                result[k, 2] = self.scene.agents[self.rows[k]].pose[2]
            else:
                w, x, y, z = self.data.qpos[address + 3 : address + 7]
                result[k, 2] = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        return result

    def twists(self) -> Floats:
        """(K, 3) vx, vy [m/s], yaw rate [rad/s] of the robots that MuJoCo moves, world frame."""
        result = np.zeros((len(self.rigs), 3))
        for k, (name, body) in enumerate(self.bodies.items()):
            first = int(self.model.jnt_dofadr[self.model.body_jntadr[body]])
            result[k, :2] = self.data.qvel[first : first + 2]
            if self.rigs[name].drive in TURNING:
                result[k, 2] = self.data.qvel[first + 2]
            elif self.rigs[name].drive != "omni":
                address = int(self.model.jnt_qposadr[self.model.body_jntadr[body]])
                w, x, y, z = self.data.qpos[address + 3 : address + 7]
                upward = np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])
                result[k, 2] = upward @ self.data.qvel[first + 3 : first + 6]  # the rate is in the frame of the body
        return result

    def warnings(self) -> dict[str, int]:
        """Warnings of MuJoCo, and how often they came."""
        import mujoco

        numbers = [int(self.data.warning[kind].number) for kind in range(int(mujoco.mjtWarning.mjNWARNING))]
        named = {int(kind.value): name for name, kind in mujoco.mjtWarning.__members__.items()}
        return {named[kind].removeprefix("mjWARN_").lower(): count for kind, count in enumerate(numbers) if count}

    # time -------------------------------------------------------------------------------------------------------------
    def advance(self, motion: Motion, watch: Callable[[Any, Any, float], None]) -> None:
        """Simulate one step of irsim, in which the objects that irsim moves go straight to the end of their step.

        Args:
            motion: Controls, and where objects are at the end of the step.
            watch: Called after each period with model, data and the time since the start of the episode.

        Raises:
            BridgeError: The physics became unstable.
        """
        self.driver.command(motion)
        begin, end = self._mocap_pose, motion.pose[self._mocap_rows]
        begin = np.where(np.isnan(begin), end, begin)
        change = end - begin
        change[:, 2] = wrap(change[:, 2])
        period = float(self.model.opt.timestep)
        targets: Floats | None = None
        with _without_log():
            for k in range(self.count):
                latest = self.driver.targets(motion.time + k * period)
                if latest is not targets:
                    targets = latest
                    self.data.ctrl[self._actuator] = targets
                if len(self._planar_first):
                    self._turn_to_world(latest)
                if len(self._mocap_rows):
                    self._show_mocaps(begin + change * ((k + 1) / self.count))
                self._step(self.model, self.data)
                watch(self.model, self.data, motion.time + (k + 1) * period)
        self._mocap_pose = end.copy()
        if not (np.isfinite(self.data.qpos).all() and np.isfinite(self.data.qvel).all()):
            raise BridgeError("bridge-failed", "the physics of MuJoCo became unstable", "use a smaller timestep")

    def _turn_to_world(self, targets: Floats) -> None:
        """Targets of planar joints, which are along the axes of the world, from velocities in the body frame."""
        turn = self.data.xmat[self._planar_body].reshape(-1, 3, 3)[:, :2, :2]
        along = np.stack([targets[self._planar_first], targets[self._planar_first + 1]], axis=1)
        world = np.einsum("kij,kj->ki", turn, along)
        self.data.ctrl[self._actuator[self._planar_first]] = world[:, 0]
        self.data.ctrl[self._actuator[self._planar_first + 1]] = world[:, 1]


@contextmanager
def _without_log() -> Iterator[None]:
    """Context in which MuJoCo only counts its warnings, instead of writing a file into the current directory, too."""
    import mujoco

    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda text: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
