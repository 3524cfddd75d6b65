"""The bridge ``carla``: objects of a scenario are actors of a town, and the town is ticked with the scenario."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import Any

import numpy as np

from irsim.bridges.base import Bridge, BridgeError, BridgeLostError
from irsim.bridges.carla.actors import Ground, Spawner, find_actor, place
from irsim.bridges.carla.client import connect, server_errors
from irsim.bridges.carla.lidars import AttachedLidar, attach_lidars
from irsim.bridges.carla.moving import shifted, steering, vehicle_commands, walker_commands
from irsim.bridges.carla.places import Places
from irsim.bridges.carla.roles import Role, cast
from irsim.bridges.scene import SceneDescription
from irsim.bridges.state import Feedback, Motion, WorldState
from irsim.common.angles import wrap
from irsim.common.arrays import Floats
from irsim.components.bridges.carla import Carla

__all__ = ["CarlaBridge", "make"]

_LONGEST_TICK = 0.1
"""Longest tick [s] that the physics of CARLA takes with its own settings."""
_SETTLING = 0.5
"""Time for which actors fall to the ground and stand, before the scenario starts [s]."""
_LAST_TRY = 2.0
"""Time for which a server that is lost is asked to destroy the actors [s]."""


def make(options: Carla) -> CarlaBridge:
    """The bridge of some options."""
    return CarlaBridge(options)


class Puppet:
    """An object and its actor.

    Attributes:
        role: What the object is.
        actor: The actor; None while the object is not in the world.
        lidars: Its lidars.
        at: x, y [m], yaw [deg] where it should be, frame of CARLA.
        lift: Height of the origin of the actor above the ground [m].
        steer: Its steering angle, positive to the left [rad].
    """

    def __init__(self, role: Role) -> None:
        self.role = role
        self.actor: Any = None
        self.lidars: list[AttachedLidar] = []
        self.at: Floats = np.full(3, np.nan)
        self.height = self.lift = self.steer = 0.0


class CarlaBridge(Bridge):
    """Connects a scenario with a running server.

    Attributes:
        ticks: Number of ticks of the server so far.
        corrections: How often a walker was put where it should be.
    """

    def __init__(self, options: Carla) -> None:
        self.name, self.clock, self.options = "carla", options.clock, options
        self.address = f"{options.host}:{options.port}"
        self.places = Places(options.transform.x, options.transform.y, options.transform.yaw)
        self.ticks = self.corrections = 0
        self._puppets: list[Puppet] = []
        self._carla: Any = None
        self._client: Any = None
        self._world: Any = None
        self._settings: Any = None
        self._spawner: Spawner | None = None
        self._ground: Ground | None = None
        self._lost = False
        self._step = 0
        self._period = self._tick = 0.1
        self._turn = 0
        self._time: float | None = None

    # the episode ------------------------------------------------------------------------------------------------------
    def open(self, scene: SceneDescription, start: WorldState) -> None:
        """Connect, make the server synchronous, and spawn the actors; after an error, nothing of it is left."""
        self._puppets = [Puppet(role) for role in cast(scene, self.options)]
        self.agents = frozenset(p.role.agent.name for p in self._puppets if p.role.external)
        self._period = scene.step_time
        self._carla, self._client, self._world = connect(self.options)
        try:
            with server_errors("setting up the town", self.address):
                self._set_up()
                self._spawner = Spawner(self._carla, self._world)
                self._ground = Ground(self._carla, self._world, self.options.ground)
                for puppet in self._puppets:
                    self._appear(puppet, start.pose[puppet.role.agent.index])
                self._settle()
        except BaseException as error:
            self._lost = isinstance(error, BridgeLostError)
            self.close()
            raise
        self._step = start.step

    def exchange(self, motion: Motion) -> Feedback | None:
        """Tell the actors what they do in this step, let it pass in CARLA, and return where its own actors are then."""
        try:
            with server_errors("a step", self.address):
                return self._exchange(motion)
        except BridgeLostError:
            self._lost = True
            raise

    def push(self, state: WorldState) -> None:
        """After a reset: put all actors back."""
        if state.step < self._step:
            with server_errors("putting actors back", self.address):
                self._put_back(state)
        self._step = state.step

    def close(self) -> None:
        """Destroy the actors and restore the settings of the server; a second call does nothing."""
        client, world, self._client, self._world = self._client, self._world, None, None
        puppets, self._puppets = self._puppets, []
        if client is None:
            return
        if self._lost:
            client.set_timeout(min(_LAST_TRY, self.options.timeout))
        for puppet in puppets:
            for lidar in puppet.lidars:
                with suppress(RuntimeError):
                    lidar.stop()
        errors = []
        for undo, of in ((self._destroy_all, client), (self._restore, world)):
            try:
                undo(of)
            except RuntimeError as error:
                errors.append(error)
                if self._lost:
                    return
        if errors:
            what = f"the CARLA server at {self.address} did not clean up: {errors[0]}"
            raise BridgeError("bridge-failed", what, "restart the server, or reload its town")

    def _destroy_all(self, client: Any) -> None:
        if self._spawner is None or not self._spawner.spawned:
            return
        doomed, self._spawner.spawned = list(reversed(self._spawner.spawned)), []
        client.apply_batch_sync([self._carla.command.DestroyActor(number) for number in doomed], False)

    def _restore(self, world: Any) -> None:
        settings, self._settings = self._settings, None
        if settings is not None:
            world.apply_settings(settings)

    # the start --------------------------------------------------------------------------------------------------------
    def _set_up(self) -> None:
        """Make the server synchronous, or check that somebody else ticks it in a way that fits."""
        settings = self._world.get_settings()
        if self.options.clock == "external":
            found = settings.fixed_delta_seconds
            if not found or abs(self._period / found - round(self._period / found)) > 1e-3:
                what = f"CARLA has ticks of {found} s, and steps of {self._period:g} s are not a whole number of them"
                fix = (
                    f"let the program that ticks CARLA set fixed_delta_seconds to {self._period:g}, or change step_time"
                )
                raise BridgeError("bridge-mismatch", what, fix)
            self._tick = float(found)
            return
        self._tick = self.options.tick or self._period / math.ceil(self._period / _LONGEST_TICK - 1e-9)
        if abs(self._period / self._tick - round(self._period / self._tick)) > 1e-6:
            what = f"steps of {self._period:g} s are not a whole number of ticks of {self._tick:g} s"
            raise BridgeError("bridge-mismatch", what, f"tick: {self._period / math.ceil(self._period / self._tick):g}")
        self._settings = self._world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, self._tick
        settings.no_rendering_mode = not self.options.rendering
        self._world.apply_settings(settings)

    def _settle(self) -> None:
        """Let actors fall to the ground."""
        if self.options.clock == "external":
            self._time = float(self._world.wait_for_tick(self.options.timeout).timestamp.elapsed_seconds)
            return
        for _ in range(math.ceil(_SETTLING / self._tick)):
            self._world.tick(self.options.timeout)
            self.ticks += 1

    def _appear(self, puppet: Puppet, pose: Floats) -> None:
        """Spawn the actor of an object, or find the one that it follows."""
        role, name = puppet.role, puppet.role.agent.name
        assert self._spawner is not None
        assert self._ground is not None
        if role.kind == "followed":
            puppet.actor = find_actor(self._world, role.followed, name)
            return
        if not np.isfinite(pose).all():
            return
        puppet.at = self.places.to_carla(shifted(pose, role.ahead))
        ground = self._ground.under(float(puppet.at[0]), float(puppet.at[1]))
        walks = role.kind == "walker"
        pattern = self.options.walker_blueprint if walks else self.options.vehicle_blueprint
        attributes = {"role_name": name, "is_invincible": "true"}
        blueprint = self._spawner.blueprint(pattern, self._turn, attributes)
        self._turn += 1
        puppet.actor = self._spawner.drop(name, blueprint, puppet.at, ground)
        puppet.lift = float(puppet.actor.bounding_box.extent.z) if walks else 0.0
        puppet.height = ground + puppet.lift
        if role.kind == "vehicle" and not role.external:
            puppet.actor.set_simulate_physics(False)
        if role.lidars:
            assert self.options.lidar is not None
            lidars = attach_lidars(
                self._carla, self._spawner, role, puppet.actor, puppet.lift, self.options.lidar, self._tick
            )
            puppet.lidars = lidars

    def _vanish(self, puppet: Puppet) -> None:
        """Destroy the actor of an object that is no longer in the world."""
        assert self._spawner is not None
        for lidar in puppet.lidars:
            lidar.stop()
            self._spawner.forget(int(lidar.sensor.id))
            lidar.sensor.destroy()
        self._spawner.forget(int(puppet.actor.id))
        puppet.actor.destroy()
        puppet.actor, puppet.lidars = None, []

    # a step -----------------------------------------------------------------------------------------------------------
    def _exchange(self, motion: Motion) -> Feedback:
        snapshot, commands = self._world.get_snapshot(), []
        for puppet in self._puppets:
            pose = motion.pose[puppet.role.agent.index]
            present = bool(np.isfinite(pose).all())
            if present and puppet.actor is None:
                self._appear(puppet, pose)
                continue
            if not present and puppet.actor is not None and puppet.role.kind != "followed":
                self._vanish(puppet)
            if present and puppet.role.kind != "followed":
                commands += self._commands(puppet, snapshot, motion)
        self._apply(commands)
        frame = self._pass_time()
        return self._feedback(frame)

    def _commands(self, puppet: Puppet, snapshot: Any, motion: Motion) -> list[Any]:
        role, number = puppet.role, int(puppet.actor.id)
        pose, twist = motion.pose[role.agent.index], motion.twist[role.agent.index]
        state = self._state_of(puppet, snapshot)
        here = state.get_transform().location
        if role.kind == "walker":
            before, after = puppet.at, self.places.to_carla(pose)
            commands, put = walker_commands(
                self._carla, number, (here.x, here.y, here.z), before, after, self._period, self.options.correction
            )
            puppet.at = after
            self.corrections += put
            return commands
        speed, puppet.steer = steering(pose, twist, self._period, role.wheelbase, puppet.steer)
        height = puppet.height
        if not role.external:
            puppet.at = self.places.to_carla(shifted(pose, role.ahead))
            assert self._ground is not None
            road = self._ground.road(float(puppet.at[0]), float(puppet.at[1]))
            height = puppet.height if road is None else road
        rise = float(state.get_velocity().z)
        return vehicle_commands(
            self._carla, number, role, self.options.command, pose, twist, speed, puppet.steer, self.places, height, rise
        )

    def _apply(self, commands: list[Any]) -> None:
        if not commands:
            return
        for answer in self._client.apply_batch_sync(commands, False):
            if answer.error:
                raise BridgeError("bridge-failed", f"CARLA refused a command: {answer.error}", "look at its log")

    def _pass_time(self) -> int:
        """Let one step pass in CARLA; the last frame of it."""
        if self.options.clock == "irsim":
            frame = 0
            for _ in range(round(self._period / self._tick)):
                frame = int(self._world.tick(self.options.timeout))
                self.ticks += 1
            return frame
        assert self._time is not None
        self._time += self._period
        snapshot = self._world.get_snapshot()
        while float(snapshot.timestamp.elapsed_seconds) < self._time - self._tick / 2:
            snapshot = self._world.wait_for_tick(self.options.timeout)
            self.ticks += 1
        return int(snapshot.frame)

    def _feedback(self, frame: int) -> Feedback:
        snapshot = self._world.get_snapshot()
        poses, twists, ranges = {}, {}, {}
        for puppet in self._puppets:
            if puppet.actor is None:
                continue
            for lidar in puppet.lidars:
                walks = puppet.role.kind == "walker"
                yaw = float(puppet.at[2]) - math.degrees(lidar.yaw) if walks else None
                ranges[lidar.lidar.key] = lidar.scan(frame, self.options.timeout, yaw)
            if puppet.role.external:
                name = puppet.role.agent.name
                poses[name], twists[name] = self._pose_of(puppet, self._state_of(puppet, snapshot))
        return Feedback(poses=poses, twists=twists, ranges=ranges)

    def _state_of(self, puppet: Puppet, snapshot: Any) -> Any:
        state = snapshot.find(int(puppet.actor.id))
        if state is None:
            what = f"the actor of '{puppet.role.agent.name}' is no longer in the town"
            raise BridgeLostError(what, "let no other program destroy it, then run the scenario again")
        return state

    def _pose_of(self, puppet: Puppet, state: Any) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Pose and velocity of an object that CARLA moves, frame of irsim."""
        transform, velocity, spin = state.get_transform(), state.get_velocity(), state.get_angular_velocity()
        at = np.array([transform.location.x, transform.location.y, transform.rotation.yaw])
        twist = self.places.velocity_to_irsim(np.array([velocity.x, velocity.y, spin.z]))
        pose = shifted(self.places.to_irsim(at), -puppet.role.ahead)
        yaw, rate, ahead = float(pose[2]), float(twist[2]), puppet.role.ahead
        vx, vy = float(twist[0]) + rate * ahead * math.sin(yaw), float(twist[1]) - rate * ahead * math.cos(yaw)
        return (float(pose[0]), float(pose[1]), float(wrap(yaw))), (vx, vy, rate)

    def _put_back(self, state: WorldState) -> None:
        commands = []
        for puppet in self._puppets:
            pose = state.pose[puppet.role.agent.index]
            if puppet.role.kind == "followed" or puppet.actor is None or not np.isfinite(pose).all():
                continue
            puppet.at = self.places.to_carla(shifted(pose, puppet.role.ahead))
            number = int(puppet.actor.id)
            commands.append(self._carla.command.ApplyTransform(number, place(self._carla, puppet.at, puppet.height)))
            if puppet.role.external:
                puppet.steer = 0.0
                still = self._carla.VehicleAckermannControl()
                commands.append(self._carla.command.ApplyVehicleAckermannControl(number, still))
                commands.append(self._carla.command.ApplyTargetVelocity(number, self._carla.Vector3D()))
        self._apply(commands)
        self._settle()
