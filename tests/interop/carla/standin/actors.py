"""Actors of the stand-in (not CARLA) and how they move; frame of CARLA: y to the right, degrees clockwise."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

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
