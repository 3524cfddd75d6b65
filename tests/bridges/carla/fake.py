"""A module with the names of the client of CARLA that the bridge uses, and a server that is a Python object."""

from __future__ import annotations

from importlib.machinery import ModuleSpec
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np


class Vector3D:
    def __init__(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> None:
        self.x, self.y, self.z = x, y, z


class Rotation:
    def __init__(self, pitch: float = 0.0, yaw: float = 0.0, roll: float = 0.0) -> None:
        self.pitch, self.yaw, self.roll = pitch, yaw, roll


class Transform:
    def __init__(self, location: Vector3D | None = None, rotation: Rotation | None = None) -> None:
        self.location, self.rotation = location or Vector3D(), rotation or Rotation()


class Blueprint:
    def __init__(self, name: str) -> None:
        self.id, self.values = name, {"role_name": ""}
        if "lidar" in name:
            self.values |= dict.fromkeys(("channels", "range", "points_per_second", "rotation_frequency"), "")

    def has_attribute(self, key: str) -> bool:
        return key in self.values

    def set_attribute(self, key: str, value: str) -> None:
        self.values[key] = value


class Library(list[Blueprint]):
    def find(self, name: str) -> Blueprint:
        return Blueprint(next(one.id for one in self if one.id == name))


class Actor:
    def __init__(self, server: Server, number: int, blueprint: Blueprint, transform: Transform) -> None:
        self.server, self.id, self.type_id, self.attributes = server, number, blueprint.id, dict(blueprint.values)
        self.transform, self.velocity, self.spin = transform, Vector3D(), Vector3D()
        self.bounding_box = SimpleNamespace(extent=Vector3D(0.2, 0.2, 0.9))
        self.listener: Any = None

    def get_transform(self) -> Transform:
        return self.transform

    def get_velocity(self) -> Vector3D:
        return self.velocity

    def get_angular_velocity(self) -> Vector3D:
        return self.spin

    def destroy(self) -> None:
        self.server.do("DestroyActor", self.id)

    def set_simulate_physics(self, enabled: bool) -> None:
        self.server.done.append(("physics", self.id, enabled))

    def listen(self, call: Any) -> None:
        self.listener = call

    def stop(self) -> None:
        self.listener = None


class Server:
    """Settings and actors of a server, which calls fail (name -> text), how many actors fit, and its calls in order."""

    def __init__(self) -> None:
        self.settings = {"synchronous_mode": False, "fixed_delta_seconds": None, "no_rendering_mode": False}
        self.actors: dict[int, Actor] = {}
        self.fail: dict[str, str] = {}
        self.version, self.room, self.frame, self.next = "0.9.16", 100, 0, 100
        self.done: list[Any] = []

    def call(self, name: str) -> None:
        if name in self.fail:
            raise RuntimeError(self.fail[name])

    def do(self, name: str, number: int, *values: Any) -> None:
        self.done.append((name, number, *values))
        actor = self.actors[number]
        if name == "DestroyActor":
            del self.actors[number]
        elif name == "ApplyTransform":
            actor.transform = values[0]
        elif name == "ApplyWalkerControl":
            direction, speed = values[0].direction, values[0].speed
            actor.velocity = Vector3D(direction.x * speed, direction.y * speed)

    def tick(self) -> int:
        self.call("tick")
        self.frame += 1
        period = self.settings["fixed_delta_seconds"] or 0.05
        for actor in self.actors.values():
            actor.transform.location.x += actor.velocity.x * period
            actor.transform.location.y += actor.velocity.y * period
            if actor.listener is not None:
                angles = np.arange(1, 360) * np.pi / 360  # 3 m away, to the left: y is to the right
                points = np.stack([3 * np.cos(angles), -3 * np.sin(angles), 0 * angles, 0 * angles], axis=1)
                points = points.astype(np.float32)
                actor.listener(SimpleNamespace(frame=self.frame, raw_data=points.tobytes(), transform=actor.transform))
        return self.frame


class World:
    def __init__(self, server: Server) -> None:
        self.server = server

    def get_settings(self) -> SimpleNamespace:
        return SimpleNamespace(**self.server.settings)

    def apply_settings(self, settings: SimpleNamespace) -> None:
        self.server.call("apply_settings")
        self.server.settings = dict(vars(settings))

    def get_map(self) -> Any:
        self.server.call("get_map")
        return SimpleNamespace(name="Carla/Maps/Town03", get_waypoint=lambda *_, **__: None)

    def get_blueprint_library(self) -> Library:
        names = ("walker.pedestrian.0001", "walker.pedestrian.0002", "vehicle.tesla.model3", "sensor.lidar.ray_cast")
        return Library(map(Blueprint, names))

    def ground_projection(self, location: Vector3D, distance: float) -> Any:
        return SimpleNamespace(location=Vector3D(location.x, location.y, 0.4))

    def try_spawn_actor(self, blueprint: Blueprint, transform: Transform) -> Actor | None:
        return None if len(self.server.actors) >= self.server.room else self.spawn_actor(blueprint, transform)

    def spawn_actor(self, blueprint: Blueprint, transform: Transform, attach_to: Any = None) -> Actor:
        self.server.call(f"spawn {blueprint.id}")
        self.server.next += 1
        actor = self.server.actors[self.server.next] = Actor(self.server, self.server.next, blueprint, transform)
        return actor

    def get_actors(self) -> list[Actor]:
        return list(self.server.actors.values())

    def get_snapshot(self) -> Any:
        return SimpleNamespace(frame=self.server.frame, find=self.server.actors.get)

    def tick(self, timeout: float) -> int:
        return self.server.tick()


class Client:
    def __init__(self, server: Server) -> None:
        self.server, self.timeouts = server, list[float]()

    def set_timeout(self, timeout: float) -> None:
        self.timeouts.append(timeout)

    def get_client_version(self) -> str:
        return "0.9.16"

    def get_world(self) -> World:
        return World(self.server)

    def apply_batch_sync(self, commands: list[Any], tick: bool) -> list[Any]:
        self.server.call("apply_batch_sync")
        self.server.done.append(("batch", len(commands)))
        for command in commands:
            self.server.do(*command)
        return [SimpleNamespace(error="") for _ in commands]


def fake_module(server: Server) -> ModuleType:
    """The module, whose clients all talk to one server."""
    module: Any = ModuleType("carla")
    module.__spec__ = ModuleSpec("carla", None)
    module.Client = lambda host, port: Client(server)
    module.Location = module.Vector3D = Vector3D
    module.Rotation, module.Transform = Rotation, Transform
    module.WalkerControl = lambda direction, speed, jump: SimpleNamespace(direction=direction, speed=speed, jump=jump)
    module.VehicleAckermannControl = lambda **values: SimpleNamespace(**values)
    module.LaneType = SimpleNamespace(Any=-1)
    kinds = (
        "ApplyTransform", "ApplyWalkerControl", "ApplyVehicleAckermannControl", "ApplyTargetVelocity",
        "ApplyTargetAngularVelocity", "DestroyActor",
    )  # fmt: skip
    module.command = SimpleNamespace(**{kind: lambda *values, kind=kind: (kind, *values) for kind in kinds})
    return module
