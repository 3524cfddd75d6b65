"""The bridge ``carla``: objects of a scenario are actors of a town, and the town is ticked with the scenario."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.base import Bridge, BridgeError, BridgeLostError
from irsim.bridges.carla.actors import Role, cast, find_actor, place
from irsim.bridges.carla.client import Town, server_errors
from irsim.bridges.carla.lidars import AttachedLidar, attach_lidars
from irsim.bridges.carla.places import (
    Places,
    pose_of_state,
    shifted,
    steering,
    still_commands,
    vehicle_commands,
    walker_commands,
)
from irsim.bridges.state import Feedback, Motion, WorldState
from irsim.common.arrays import Floats
from irsim.components.bridges.carla import Carla
from irsim.simulation.scene import SceneDescription

__all__ = ["CarlaBridge", "make"]

Triple = tuple[float, float, float]


def make(options: Carla) -> CarlaBridge:
    """The bridge of some options."""
    return CarlaBridge(options)


class Puppet:
    """An object and its actor.

    Attributes:
        role: Role of the object in CARLA.
        actor: The actor; None while the object is not in the world.
        lidars: Its lidars.
        at: x, y [m], yaw [deg] where it should be, frame of CARLA.
        height: z of its transform on the ground where it was spawned [m].
        steer: Its steering angle, positive to the left [rad].
    """

    def __init__(self, role: Role) -> None:
        self.role = role
        self.actor: Any = None
        self.lidars: list[AttachedLidar] = []
        self.at: Floats = np.full(3, np.nan)
        self.height = self.steer = 0.0


class CarlaBridge(Bridge):
    """Connects a scenario with a running server.

    Attributes:
        ticks: Number of ticks of the server so far.
        corrections: How often a walker was put where it should be.
    """

    def __init__(self, options: Carla) -> None:
        self.name, self.clock, self.options = "carla", options.clock, options
        self.places = Places(options.transform.x, options.transform.y, options.transform.yaw)
        self.ticks = self.corrections = 0
        self._town: Town | None = None
        self._puppets: list[Puppet] = []
        self._lost = False
        self._step = 0
        self._turn = 0

    @property
    def peer(self) -> str:
        """The server."""
        return f"the CARLA server at {self.options.host}:{self.options.port}"

    # the episode ------------------------------------------------------------------------------------------------------
    def open(self, scene: SceneDescription, start: WorldState) -> None:
        """Connect, make the server synchronous, and spawn the actors; after an error, nothing of it is left."""
        self._puppets = [Puppet(role) for role in cast(scene, self.options)]
        self.agents = frozenset(p.role.agent.name for p in self._puppets if p.role.external)
        self._step = start.step
        try:
            with self._guarded("setting up the town"):
                self._town = Town(self.options, scene.step_time)
                self._town.take_over()
                for puppet in self._puppets:
                    self._appear(self._town, puppet, start.pose[puppet.role.agent.index])
                self._town.settle()
        except BaseException:
            with suppress(BridgeError):  # the first error says more
                self.close()
            raise

    def exchange(self, motion: Motion) -> Feedback | None:
        """Tell the actors what they do in this step, let it pass in CARLA, and return where its own actors are then."""
        town = self._town
        assert town is not None
        with self._guarded("a step"):
            snapshot, commands = town.world.get_snapshot(), []
            for puppet in self._puppets:
                commands += self._commands(town, puppet, snapshot, motion)
            town.apply(commands)
            frame = town.pass_time()
            self.ticks = town.ticks
            return self._feedback(town, frame)

    def push(self, state: WorldState) -> None:
        """After a reset: put all actors back."""
        if state.step < self._step and self._town is not None:
            with self._guarded("putting actors back"):
                self._put_back(self._town, state)
        self._step = state.step

    def close(self) -> None:
        """Destroy the actors and restore the settings of the server; a second call does nothing."""
        town, self._town = self._town, None
        puppets, self._puppets = self._puppets, []
        if town is None:
            return
        for puppet in puppets:
            for lidar in puppet.lidars:
                with suppress(RuntimeError):
                    lidar.stop()
        town.leave(lost=self._lost)

    def _guarded(self, what: str) -> Any:
        return server_errors(what, f"{self.options.host}:{self.options.port}", self._lose)

    def _lose(self) -> None:
        self._lost = True

    # objects come and go ----------------------------------------------------------------------------------------------
    def _appear(self, town: Town, puppet: Puppet, pose: Floats) -> None:
        """Spawn the actor of an object, or find the one that it follows."""
        role, name = puppet.role, puppet.role.agent.name
        if role.kind == "followed":
            puppet.actor = find_actor(town.world, role.followed, name)
            return
        if not np.isfinite(pose).all():
            return
        puppet.at = self.places.to_carla(shifted(pose, role.ahead))
        ground = town.ground.under(float(puppet.at[0]), float(puppet.at[1]))
        walks = role.kind == "walker"
        pattern = self.options.walker_blueprint if walks else self.options.vehicle_blueprint
        blueprint = town.spawner.blueprint(pattern, self._turn, {"role_name": name, "is_invincible": "true"})
        self._turn += 1
        puppet.actor = town.spawner.drop(name, blueprint, puppet.at, ground)
        lift = float(puppet.actor.bounding_box.extent.z) if walks else 0.0  # walkers have their origin in the middle
        puppet.height = ground + lift
        if role.kind == "vehicle" and not role.external:
            puppet.actor.set_simulate_physics(False)
        if role.lidars:
            assert self.options.lidar is not None
            lidars = attach_lidars(town.carla, town.spawner, role, puppet.actor, lift, self.options.lidar, town.tick)
            puppet.lidars = lidars

    def _vanish(self, town: Town, puppet: Puppet) -> None:
        """Destroy the actor of an object that is no longer in the world."""
        for lidar in puppet.lidars:
            lidar.stop()
            town.spawner.destroy(lidar.sensor)
        town.spawner.destroy(puppet.actor)
        puppet.actor, puppet.lidars = None, []

    # a step -----------------------------------------------------------------------------------------------------------
    def _commands(self, town: Town, puppet: Puppet, snapshot: Any, motion: Motion) -> list[Any]:
        role, pose = puppet.role, motion.pose[puppet.role.agent.index]
        if role.kind == "followed":
            return []
        if not np.isfinite(pose).all():
            if puppet.actor is not None:
                self._vanish(town, puppet)
            return []
        if puppet.actor is None:
            self._appear(town, puppet, pose)
            return []
        number, state = int(puppet.actor.id), self._state_of(puppet, snapshot)
        if role.kind == "walker":
            here = state.get_transform().location
            before, puppet.at = puppet.at, self.places.to_carla(pose)
            commands, put = walker_commands(
                town.carla, number, (here.x, here.y, here.z), before, puppet.at, town.period, self.options.correction
            )
            self.corrections += put
            return commands
        twist = motion.twist[role.agent.index]
        speed, puppet.steer = steering(pose, twist, town.period, role.wheelbase, puppet.steer)
        height = puppet.height
        if not role.external:
            puppet.at = self.places.to_carla(shifted(pose, role.ahead))
            road = town.ground.road(float(puppet.at[0]), float(puppet.at[1]))
            height = puppet.height if road is None else road
        rise, how = float(state.get_velocity().z), self.options.command
        return vehicle_commands(
            town.carla, number, role, how, pose, twist, speed, puppet.steer, self.places, height, rise
        )

    def _feedback(self, town: Town, frame: int) -> Feedback:
        snapshot = town.world.get_snapshot()
        poses: dict[str, Triple] = {}
        twists: dict[str, Triple] = {}
        ranges: dict[str, NDArray[np.float32]] = {}
        for puppet in self._puppets:
            if puppet.actor is None:
                continue
            for lidar in puppet.lidars:
                walks = puppet.role.kind == "walker"
                yaw = float(puppet.at[2]) - math.degrees(lidar.yaw) if walks else None
                ranges[lidar.lidar.key] = lidar.scan(frame, self.options.timeout, yaw)
            if puppet.role.external:
                name, state = puppet.role.agent.name, self._state_of(puppet, snapshot)
                poses[name], twists[name] = pose_of_state(state, self.places, puppet.role.ahead)
        return Feedback(poses=poses, twists=twists, ranges=ranges)

    def _state_of(self, puppet: Puppet, snapshot: Any) -> Any:
        state = snapshot.find(int(puppet.actor.id))
        if state is None:
            what = f"the actor of '{puppet.role.agent.name}' is no longer in the town"
            raise BridgeLostError(what, "let no other program destroy it, then run the scenario again")
        here = state.get_transform().location
        if not math.isfinite(here.x + here.y + here.z):
            what = f"CARLA says that '{puppet.role.agent.name}' is at {here.x}, {here.y}, {here.z}"
            raise BridgeError("bridge-failed", what, "reload the town of the server")
        return state

    def _put_back(self, town: Town, state: WorldState) -> None:
        commands = []
        for puppet in self._puppets:
            pose = state.pose[puppet.role.agent.index]
            if puppet.role.kind == "followed" or puppet.actor is None or not np.isfinite(pose).all():
                continue
            puppet.at, puppet.steer = self.places.to_carla(shifted(pose, puppet.role.ahead)), 0.0
            number = int(puppet.actor.id)
            commands.append(town.carla.command.ApplyTransform(number, place(town.carla, puppet.at, puppet.height)))
            if puppet.role.external:
                commands += still_commands(town.carla, number)
        town.apply(commands)
        town.settle()
