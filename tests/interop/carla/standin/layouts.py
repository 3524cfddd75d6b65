"""Layouts of what the stand-in (not CARLA) sends: records of calls, and frames of streams; frame of CARLA."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np

from tests.interop.carla.standin.town import Actor

LIDAR, SNAPSHOT = 11, 17
"""Places of the kinds of sensors in the registry of the client."""
SNAPSHOT_STREAM = 1
BOOL, INT, FLOAT, STRING = 1, 2, 3, 4


def token(stream: int, port: int) -> bytes:
    """24 bytes: id of a stream, port, TCP, IPv4, address."""
    return struct.pack("<IHBB", stream, port, 1, 1) + bytes((127, 0, 0, 1)) + bytes(12)


def definition(number: int, name: str, tags: str, attributes: dict[str, tuple[int, list[str]]]) -> list[Any]:
    """A blueprint."""
    return [
        number,
        name,
        tags,
        [[key, kind, values[0], values, True, False] for key, (kind, values) in attributes.items()],
    ]


def bounding_box(actor: Actor) -> list[Any]:
    """Location, half the size, rotation, and the id of the actor."""
    length, width, height = actor.size
    return [[0.0, 0.0, 0.0], [length / 2, width / 2, height / 2], [0.0, 0.0, 0.0], actor.id]


def actor_record(actor: Actor, port: int) -> list[Any]:
    """An actor as calls return it."""
    stream = token(actor.stream, port) if actor.stream else b""
    return [actor.id, actor.parent or 0, actor.description, bounding_box(actor), bytes((actor.tag,)), stream]


def _pose(actor: Actor) -> tuple[float, ...]:
    x, y, z = actor.location
    return x, y, z, 0.0, actor.yaw, 0.0


def _message(kind: int, frame: int, time: float, pose: tuple[float, ...], payload: bytes) -> bytes:
    """A message of a stream: header of 48 bytes, then what the kind of sensor sends."""
    return struct.pack("<QQd6f", kind, frame, time, *pose) + payload


def snapshot(frame: int, time: float, step: float, actors: list[Actor]) -> bytes:
    """The state of all actors: a header of 36 bytes, then 119 bytes for each."""
    parts = [struct.pack("<Qdf3iI", 1, time, step, 0, 0, 0, 0)]
    for actor in actors:
        vx, vy = actor.velocity
        parts.append(struct.pack("<IB6f", actor.id, 2, *_pose(actor)))
        parts.append(struct.pack("<9f", vx, vy, 0, 0, 0, actor.turn_rate, 0, 0, 0))
        parts.append(bytes(54))
    return _message(SNAPSHOT, frame, time, (0.0,) * 6, b"".join(parts))


def lidar(frame: int, time: float, actor: Actor, channels: list[Any]) -> bytes:
    """Points of a lidar, one array (n, 4) for each channel."""
    counts = struct.pack("<fI", 0.0, len(channels)) + struct.pack(f"<{len(channels)}I", *map(len, channels))
    points = np.concatenate(channels).astype("<f4").tobytes()
    return _message(LIDAR, frame, time, _pose(actor), counts + points)
