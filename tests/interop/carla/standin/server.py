"""Calls and streams of the stand-in (not CARLA): msgpack-rpc on one port, streams on the next."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import struct
from collections.abc import Mapping
from typing import Any, TextIO

import msgpack

from tests.interop.carla.standin import layouts
from tests.interop.carla.standin.town import WHEELBASE, Actor, Town

LIDAR_KEYS = {
    "role_name": "lidar", "channels": "32", "range": "10.0", "points_per_second": "56000", "rotation_frequency": "10.0",
    "upper_fov": "10.0", "lower_fov": "-30.0", "horizontal_fov": "360.0", "atmosphere_attenuation_rate": "0.004",
    "dropoff_general_rate": "0.45", "dropoff_intensity_limit": "0.8", "dropoff_zero_intensity": "0.4",
    "noise_stddev": "0.0", "sensor_tick": "0.0",
}  # fmt: skip
KINDS = {"channels": layouts.INT, "points_per_second": layouts.INT, "role_name": layouts.STRING}


def blueprints() -> list[Any]:
    """Blueprints of two walkers, two vehicles, a lidar and a box."""
    role = (layouts.STRING, ["pedestrian"])
    walker = {"role_name": role, "is_invincible": (layouts.BOOL, ["true"]), "speed": (layouts.FLOAT, ["0.0", "1.4"])}
    vehicle = {"role_name": (layouts.STRING, ["autopilot"]), "color": (layouts.STRING, ["255,0,0"])}
    lidar = {key: (KINDS.get(key, layouts.FLOAT), [value]) for key, value in LIDAR_KEYS.items()}
    return [
        layouts.definition(1, "walker.pedestrian.0001", "walker,pedestrian,0001", walker),
        layouts.definition(2, "walker.pedestrian.0002", "walker,pedestrian,0002", walker),
        layouts.definition(3, "vehicle.tesla.model3", "vehicle,tesla,model3", vehicle),
        layouts.definition(4, "vehicle.micro.microlino", "vehicle,micro,microlino", vehicle),
        layouts.definition(5, "sensor.lidar.ray_cast", "sensor,lidar,ray_cast", lidar),
        layouts.definition(6, "static.prop.box", "static,prop,box", {"role_name": (layouts.STRING, ["prop"])}),
    ]


class Server:
    """Answers calls of the official client at a port, sends streams at the next one, logs events as lines of JSON."""

    def __init__(self, facts: Mapping[str, Any], port: int, log: TextIO | None) -> None:
        self.facts, self.port, self.log = facts, port, log
        self.town = Town(facts)
        self.asked = 0  # ticks that a client asked for
        self.subscribers: dict[int, list[asyncio.StreamWriter]] = {}
        for role, kind, x, y, yaw in facts.get("others", ()):
            number = next(entry[0] for entry in blueprints() if entry[1] == kind)
            description = [number, kind, [["role_name", layouts.STRING, role]]]
            other = self.town.spawn(description, [[x, y, self.town.ground + 1.0], [0.0, yaw, 0.0]])
            other.control = tuple(facts.get("others_do", ()))

    def note(self, what: str, **facts: Any) -> None:
        """Log."""
        if self.log is not None:
            self.log.write(json.dumps({"what": what, "frame": self.town.frame, **facts}) + "\n")
            self.log.flush()

    async def serve(self) -> None:
        """Serve until cancelled."""
        calls = await asyncio.start_server(self.answer_calls, "127.0.0.1", self.port)
        streams = await asyncio.start_server(self.send_stream, "127.0.0.1", self.port + 1)
        print(f"stand-in, not CARLA: listening on {self.port}", flush=True)
        async with calls, streams:
            while True:
                await asyncio.sleep(0.02)
                if not self.town.settings[0]:  # as a server that is not synchronous, which goes on by itself
                    self.tick()

    async def answer_calls(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Answer the calls of a client, in order."""
        unpacker = msgpack.Unpacker(raw=False, strict_map_key=False)
        with contextlib.suppress(ConnectionError, asyncio.IncompleteReadError):
            while chunk := await reader.read(65536):
                unpacker.feed(chunk)
                for message in unpacker:
                    if self.facts.get("silent") or self.asked >= self.facts.get("hang_after", 10**9):
                        continue
                    if message[0] == 0:
                        _, number, method, (_, *values) = message
                        writer.write(msgpack.packb([1, number, None, self.call(method, values)]))
                        await writer.drain()
                    else:
                        _, method, (_, *values) = message
                        self.call(method, values)
        writer.close()

    async def send_stream(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Let a client subscribe to a stream."""
        with contextlib.suppress(ConnectionError, asyncio.IncompleteReadError):
            (stream,) = struct.unpack("<I", await reader.readexactly(4))
            self.subscribers.setdefault(stream, []).append(writer)
            self.note("subscribed", stream=stream)
            await reader.read()
            self.subscribers[stream].remove(writer)

    def send(self, stream: int, message: bytes) -> None:
        """Send a message to all subscribers of a stream."""
        for writer in self.subscribers.get(stream, ()):
            if not writer.is_closing():
                writer.write(struct.pack("<I", len(message)) + message)

    def tick(self) -> int:
        """Advance, and send what sensors see."""
        town = self.town
        town.tick()
        self.asked += town.settings[0]
        if self.asked >= self.facts.get("die_after", 10**9):
            os._exit(3)
        for actor in list(town.actors.values()):
            if actor.stream and self.subscribers.get(actor.stream):
                self.send(actor.stream, layouts.lidar(town.frame, town.time, actor, town.lidar(actor)))
        actors = list(town.actors.values())
        self.send(layouts.SNAPSHOT_STREAM, layouts.snapshot(town.frame, town.time, town.step, actors))
        if not town.settings[0]:
            return town.frame
        places = {a.id: [a.kind, *a.location, a.yaw] for a in actors if a.parent is None}
        self.note("tick", places=places)
        return town.frame

    def call(self, method: str, values: list[Any]) -> Any:
        """The answer to a call: ``[[1, value]]``, ``[[False]]`` without one, ``[[0, [message]]]`` for an error."""
        handler = getattr(self, f"call_{method}", None)
        if handler is None:
            self.note("unknown", method=method, values=repr(values)[:200])
            return [[0, [f"the stand-in has no call {method}"]]]
        try:
            value = handler(*values)
        except (ValueError, KeyError) as error:
            self.note("refused", method=method, why=str(error))
            return [[0, [str(error)]]]
        if method in ("apply_batch", "project_point"):
            return value
        return [[False]] if value is None else [[1, value]]

    def call_version(self) -> str:
        return str(self.facts.get("version", "0.9.16"))

    def call_get_episode_info(self) -> Any:
        return [1, [layouts.token(layouts.SNAPSHOT_STREAM, self.port + 1)]]

    def call_get_sensor_token(self, stream: int) -> Any:
        return [layouts.token(stream, self.port + 1)]

    def call_get_episode_settings(self) -> Any:
        return self.town.settings

    def call_set_episode_settings(self, settings: list[Any]) -> int:
        self.town.settings = settings
        self.note("settings", settings=settings)
        return self.tick()

    def call_get_required_files(self, _folder: str) -> list[str]:
        return []

    def call_query_lights_state(self, _client: str) -> list[Any]:
        return []

    def call_get_map_info(self) -> Any:
        return [str(self.facts.get("name", "StandInTown")), [[[0.0, 0.0, 0.5], [0.0, 0.0, 0.0]]]]

    def call_get_map_data(self) -> str:
        return str(self.facts.get("road", ""))

    def call_get_available_maps(self) -> list[str]:
        return ["/Game/Carla/Maps/StandInTown"]

    def call_get_actor_definitions(self) -> Any:
        return blueprints()

    def call_spawn_actor(self, description: list[Any], pose: list[Any]) -> Any:
        actor = self.town.spawn(description, pose)
        self.note("spawn", id=actor.id, blueprint=description[1], attributes=actor.attributes, pose=pose)
        return layouts.actor_record(actor, self.port + 1)

    def call_spawn_actor_with_parent(self, description: list[Any], pose: list[Any], parent: int, *_: Any) -> Any:
        actor = self.town.spawn(description, pose, parent)
        self.note("spawn", id=actor.id, blueprint=description[1], attributes=actor.attributes, pose=pose, parent=parent)
        return layouts.actor_record(actor, self.port + 1)

    def call_get_actors_by_id(self, ids: list[int]) -> Any:
        return [layouts.actor_record(self.town.actors[one], self.port + 1) for one in ids if one in self.town.actors]

    def call_get_actor_bounding_box(self, number: int) -> Any:
        return layouts.bounding_box(self._actor(number))

    def call_destroy_actor(self, number: int) -> bool:
        if self.town.actors.pop(number, None) is None:
            raise ValueError(f"there is no actor {number}")
        self.note("destroy", id=number)
        return True

    def call_project_point(self, location: list[float], _direction: list[float], distance: float) -> Any:
        x, y, z = location
        hit = z - distance <= self.town.ground <= z
        return [[1, [True, [[x, y, self.town.ground], 1]]]] if hit else [[1, [False, [[0.0, 0.0, 0.0], 0]]]]

    def call_tick_cue(self) -> int:
        return self.tick()

    def call_apply_control_to_walker(self, number: int, control: list[Any]) -> None:
        (x, y, _), speed, _ = control
        self._actor(number).control = ("walker", x, y, speed)

    def call_apply_ackermann_control_to_vehicle(self, number: int, control: list[Any]) -> None:
        steer, _, speed, *_ = control
        self.note("ackermann", id=number, steer=steer, speed=speed, wheelbase=WHEELBASE)
        self._actor(number).control = ("ackermann", steer, speed)

    def call_set_actor_target_velocity(self, number: int, velocity: list[float]) -> None:
        self.note("velocity", id=number, velocity=velocity)
        self._actor(number).control = ("velocity", velocity[0], velocity[1])

    def call_set_actor_target_angular_velocity(self, number: int, rate: list[float]) -> None:
        self.note("turn", id=number, rate=rate)
        self._actor(number).spin = rate[2]

    def call_set_actor_transform(self, number: int, pose: list[Any]) -> None:
        actor = self._actor(number)
        self.note("transform", id=number, before=[*actor.location, actor.yaw], pose=pose)
        actor.location, actor.yaw = list(map(float, pose[0])), float(pose[1][1])

    def call_set_actor_simulate_physics(self, number: int, enabled: bool) -> None:
        self._actor(number).physics = enabled

    def call_apply_batch(self, commands: list[Any], tick: bool) -> Any:
        """Commands are pairs of a number and its values."""
        self.note("batch", kinds=[entry[0][0] for entry in commands], tick=tick)
        answers: list[Any] = []
        for ((kind, values),) in commands:
            try:
                self._command(kind, values)
            except (ValueError, KeyError) as error:
                answers.append([[0, [str(error)]]])
            else:
                answers.append([[1, values[0]]])
        if tick:
            self.tick()
        return answers

    def _command(self, kind: int, values: list[Any]) -> None:
        names = {
            1: self.call_destroy_actor,
            3: self.call_apply_ackermann_control_to_vehicle,
            4: self.call_apply_control_to_walker,
            6: self.call_set_actor_transform,
            8: self.call_set_actor_target_velocity,
            9: self.call_set_actor_target_angular_velocity,
            14: self.call_set_actor_simulate_physics,
        }
        if kind not in names:
            self.note("unknown", method=f"command {kind}", values=repr(values)[:200])
            raise ValueError(f"the stand-in has no command {kind}")
        names[kind](*values)

    def _actor(self, number: int) -> Actor:
        return self.town.actors[number]
