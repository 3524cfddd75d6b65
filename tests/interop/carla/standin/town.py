"""The town of the stand-in (not CARLA): walls, actors, ticks and rays; frame of CARLA."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
SIZES = {
    "walker": (0.4, 0.4, 1.86),
    "vehicle": (3.0, 1.4, 1.5),
    "vehicle.micro.microlino": (0.6, 0.6, 1.0),
    "static": (1.0, 1.0, 1.0),
    "sensor": (0.1, 0.1, 0.1),
}
"""Length, width, height [m] by kind or blueprint; made up."""
TAGS = {"walker": 12, "vehicle": 14, "static": 20, "sensor": 0}
NEAR = 0.5
"""Actors do not spawn nearer to the ground than this [m], so that a client has to try again from higher up."""


class Town:
    """All that there is: walls, ground, drift, room for actors, and the ticks of a server that is not synchronous."""

    def __init__(self, facts: Mapping[str, Any]) -> None:
        walls = [np.array(points, dtype=np.float64) for points in facts.get("walls", ())]
        self.starts = np.concatenate([w[:-1] for w in walls]) if walls else np.zeros((0, 2))
        self.ends = np.concatenate([w[1:] for w in walls]) if walls else np.zeros((0, 2))
        self.ground, self.drift = float(facts.get("ground", 0.0)), float(facts.get("drift", 0.0))
        self.full = int(facts.get("full", 10_000))
        self.actors: dict[int, Actor] = {}
        self.settings: list[Any] = [False, False, [False], True, 0.01, 10, 0.0, True, 3000.0, 2000.0, True]
        if "fixed" in facts:
            self.settings[2] = [True, float(facts["fixed"])]
        self.frame, self.time, self._next, self._seed = 10, 1.0, 20, 0

    @property
    def step(self) -> float:
        """Period of a tick [s]."""
        period = self.settings[2]  # [False] or [True, period]
        return float(period[1]) if period[0] else 0.05

    def spawn(self, description: list[Any], pose: list[Any], parent: int | None = None) -> Actor:
        """Make an actor; an error where there is no room."""
        location, (_, yaw, _) = list(map(float, pose[0])), map(float, pose[1])
        kind = str(description[1]).split(".")[0]
        if parent is None:
            if location[2] < self.ground + NEAR - 1e-3:
                raise ValueError("Spawn failed because of collision at spawn position")
            if sum(actor.parent is None for actor in self.actors.values()) >= self.full:
                raise ValueError("Spawn failed because of collision at spawn position")
            location[2] = self.ground + (SIZES[kind][2] / 2 if kind == "walker" else 0.0)
        self._next += 1
        size = SIZES.get(str(description[1]), SIZES[kind])
        actor = Actor(self._next, description, location, yaw, size, TAGS[kind], parent)
        if kind == "sensor":
            actor.stream = self._next
            actor.mount = (*location, yaw)  # type: ignore[assignment]
            if parent is not None:
                actor.follow(self.actors[parent])
        self.actors[actor.id] = actor
        return actor

    def tick(self) -> None:
        """Advance by one period."""
        self.frame += 1
        self.time += self.step
        for actor in self.actors.values():
            if actor.parent is None:
                actor.move(self.step, self.drift)
        for actor in self.actors.values():
            if actor.parent in self.actors:
                actor.follow(self.actors[actor.parent])

    def lidar(self, sensor: Actor) -> list[Floats]:
        """Points of one tick: for each channel (n, 4) x, y, z, intensity in the frame of the sensor."""
        facts = sensor.attributes
        channels, longest = int(facts["channels"]), float(facts["range"])
        turn = min(1.0, float(facts["rotation_frequency"]) * self.step)
        count = round(float(facts["points_per_second"]) * self.step / channels)
        angles = np.arange(count) * (2 * math.pi * turn / count)
        low, high = float(facts["lower_fov"]), float(facts["upper_fov"])
        ranges = self.cast(sensor, angles)
        points = []
        for tilt in np.radians([high] if channels == 1 else np.linspace(high, low, channels)):
            down = (sensor.location[2] - self.ground) / -math.tan(tilt) if tilt < -1e-9 else math.inf
            flat = np.minimum(ranges, down)
            seen = flat / math.cos(tilt) < longest
            x, y = flat[seen] * np.cos(angles[seen]), flat[seen] * np.sin(angles[seen])
            points.append(np.stack([x, y, flat[seen] * math.tan(tilt), np.full(len(x), 0.9)], axis=1))
        return points

    def cast(self, sensor: Actor, angles: Floats) -> Floats:
        """(n,) horizontal distances to walls and actors, infinite without one; the parent is not seen."""
        origin = np.array(sensor.location[:2])
        course = angles + math.radians(sensor.yaw)
        rays = np.stack([np.cos(course), np.sin(course)], axis=1)
        starts, ends = [self.starts], [self.ends]
        distances = np.full(len(rays), np.inf)
        for actor in self.actors.values():
            if actor.parent is not None or actor.id == sensor.parent:
                continue
            if actor.kind == "walker":
                distances = np.minimum(
                    distances, _to_disk(origin, rays, np.array(actor.location[:2]), actor.size[0] / 2)
                )
                continue
            length, width, _ = actor.size
            cosine, sine = math.cos(math.radians(actor.yaw)), math.sin(math.radians(actor.yaw))
            box = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * (length / 2, width / 2)
            corners = box @ np.array([[cosine, sine], [-sine, cosine]]) + actor.location[:2]
            starts.append(corners)
            ends.append(np.roll(corners, -1, axis=0))
        return np.minimum(distances, _to_segments(origin, rays, np.concatenate(starts), np.concatenate(ends)))


def _to_disk(origin: Floats, rays: Floats, center: Floats, radius: float) -> Floats:
    away = center - origin
    along = rays @ away
    inside = radius**2 - (away @ away - along**2)
    distance = along - np.sqrt(np.maximum(inside, 0.0))
    return np.where((inside > 0) & (distance > 0), distance, np.inf)


def _to_segments(origin: Floats, rays: Floats, starts: Floats, ends: Floats) -> Floats:
    if not len(starts):
        return np.full(len(rays), np.inf)
    side, away = ends - starts, starts - origin
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = rays[:, None, 0] * side[None, :, 1] - rays[:, None, 1] * side[None, :, 0]
        distance = (away[None, :, 0] * side[None, :, 1] - away[None, :, 1] * side[None, :, 0]) / turn
        part = (away[None, :, 0] * rays[:, None, 1] - away[None, :, 1] * rays[:, None, 0]) / turn
    hit = (distance > 0) & (part >= 0) & (part <= 1)
    return np.where(hit, distance, np.inf).min(axis=1)


WHEELBASE = 2.0
"""Of all vehicles [m]."""


@dataclass
class Actor:
    """A walker, a vehicle or a sensor; angles in degrees, lengths in metres."""

    id: int
    description: list[Any]  # number, name and attributes of its blueprint, as the client sent them
    location: list[float]
    yaw: float
    size: tuple[float, float, float]  # length, width, height
    tag: int
    parent: int | None = None
    mount: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)  # x, y, z, yaw of a sensor on its parent
    stream: int = 0
    velocity: tuple[float, float] = (0.0, 0.0)
    turn_rate: float = 0.0
    control: tuple[Any, ...] = ()  # ("walker", x, y, speed), ("ackermann", steer, speed) or ("velocity", x, y)
    spin: float = 0.0
    physics: bool = True
    attributes: dict[str, str] = field(init=False)

    def __post_init__(self) -> None:
        self.attributes = {str(key): str(value) for key, _, value in self.description[2]}

    @property
    def kind(self) -> str:
        """``walker``, ``vehicle``, ``sensor`` or ``static``."""
        return str(self.description[1]).split(".")[0]

    def move(self, dt: float, drift: float) -> None:
        """Advance by a tick; walkers fall short of their speed by the share ``drift``, as animated walks do."""
        self.turn_rate = 0.0
        if not self.control:
            self.velocity = 0.0, 0.0
            return
        what, *values = self.control
        if what == "walker":
            x, y, speed = values
            norm = math.hypot(x, y)
            speed *= 1.0 - drift
            self.velocity = (x / norm * speed, y / norm * speed) if norm > 0 else (0.0, 0.0)
            if norm > 0 and speed > 0:
                self.yaw = math.degrees(math.atan2(y, x))
        elif what == "ackermann":  # in CARLA a positive steering angle turns right, as its yaw does
            steer, speed = values
            self.turn_rate = math.degrees(speed / WHEELBASE * math.tan(steer))
            course = math.radians(self.yaw + self.turn_rate * dt / 2)
            self.velocity = speed * math.cos(course), speed * math.sin(course)
        else:
            self.velocity = values[0], values[1]
            self.turn_rate = self.spin
        self.location[0] += self.velocity[0] * dt
        self.location[1] += self.velocity[1] * dt
        self.yaw = math.remainder(self.yaw + self.turn_rate * dt, 360.0)

    def follow(self, parent: Actor) -> None:
        """Put a sensor where its parent carries it."""
        x, y, z, yaw = self.mount
        cosine, sine = math.cos(math.radians(parent.yaw)), math.sin(math.radians(parent.yaw))
        px, py, pz = parent.location
        self.location = [px + cosine * x - sine * y, py + sine * x + cosine * y, pz + z]
        self.yaw = parent.yaw + yaw
