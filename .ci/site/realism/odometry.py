"""Squares of a robot that follows wrong odometry, against arcs by hand, and what they say of its wheels."""

from __future__ import annotations

import math

import numpy as np
import yaml

from irsim.common.arrays import Floats
from irsim.components.sensors.odometry import Odometry
from realism.simulated import driven, opened, readings
from realism.validation import Curve, Validation
from tests.core.estimators import umbmark

__all__ = ["validation"]

SIDE = 4.0
"""Side of the squares [m]."""
LEGS = [part for _ in range(4) for part in ((SIDE, 0.0), (0.0, math.pi / 2))]
"""Way [m] and turn [rad] of each part of a square to the left."""


def _driven(text: str, dt: float, side: int) -> tuple[Floats, Floats]:
    """(K, 2) the true and the believed way of a robot that drives until odometry says what it wants.

    Args:
        text: The scenario.
        dt: Its period [s].
        side: 1 for a square to the left, -1 for one to the right.
    """
    batch, ways = opened(text), []
    wanted, believed = np.zeros(2), np.zeros(2)  # way [m] and turn [rad] since the start
    for way, turn in LEGS:
        steps = round((way + turn) / dt)  # at 1 m/s and 1 rad/s
        for _ in range(steps):
            wanted += np.array([way, side * turn]) / steps
            for _ in driven(batch, (wanted - believed) / dt, 1):
                read = readings(batch)[0]
            believed += dt * read[[3, 5]]
            ways.append([*batch.pose[0, 0, :2], *read[:2]])
    both = np.array(ways)
    return both[:, :2], both[:, 2:]


def _by_hand(sensor: Odometry, start: Floats, side: int) -> Floats:
    """(K, 2) the true way of a square that odometry believes to be exact, in small arcs."""
    unequal, track = 1 + sensor.diameter_error, sensor.track * (1 + sensor.track_error)
    x, y, heading = start
    ways, parts = [(x, y)], 50
    for way, turn in LEGS:
        left = (way - side * turn * sensor.track / 2) * 2 / (1 + unequal) / parts
        right = (way + side * turn * sensor.track / 2) * 2 * unequal / (1 + unequal) / parts
        for _ in range(parts):
            turned = (right - left) / track
            x += (left + right) / 2 * math.cos(heading + turned / 2)
            y += (left + right) / 2 * math.sin(heading + turned / 2)
            heading += turned
            ways.append((x, y))
    return np.array(ways)


def validation(text: str) -> Validation:
    """A square to the left and one to the right, as in UMBmark."""
    scene = yaml.safe_load(text)
    sensor, dt = Odometry(**scene["robot"]["sensors"][0]), scene["world"]["step_time"]
    points, lines, ends = [], [], []
    for tone, (side, word) in enumerate(((1, "left"), (-1, "right"))):
        true, believed = _driven(text, dt, side)
        ends.append(true[-1, 0] - believed[-1, 0])
        law = _by_hand(sensor, np.array(scene["robot"]["state"]), side)
        points.append(Curve(f"true way to the {word}", true[::30, 0], true[::30, 1], tone))
        lines.append(Curve("", law[:, 0], law[:, 1], tone))
        label = "what odometry believes" if side == 1 else ""
        lines.append(Curve(label, believed[:, 0], believed[:, 1], 3, faint=True))
    counter, clockwise = ends
    unequal, _ = umbmark(clockwise, counter, SIDE, sensor.track)
    return Validation(
        x="x [m]",
        y="y [m]",
        points=tuple(points),
        lines=tuple(lines),
        quantity="Diameter of the right wheel over the left one, found from both ends",
        measured=unequal,
        expected=1 + sensor.diameter_error,
        tolerance=1e-3,
        unit="",
        setup=f"A robot drives squares of {SIDE:g} m by odometry; lines are the arcs of its wheels.",
        paths=True,
    )
