"""How far wheel odometry is off at the end of a way, in closed form, to the first order of its errors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from irsim.common.angles import wrap
from irsim.components.sensors.odometry import Odometry

__all__ = ["Drift", "drift_of"]

Point = tuple[float, float]


class Drift(NamedTuple):
    """Error of the believed position at the end of a way.

    Attributes:
        error: Root mean square of the distance between the believed and the true position [m].
        parts: Key of the sensor -> the error that it alone would make [m], for keys that make one.
    """

    error: float
    parts: Mapping[str, float]


def drift_of(sensor: Odometry, legs: Sequence[tuple[Point, Point]], heading: float | None) -> Drift:
    """The drift along straight legs, between which the robot turns on the spot.

    An error of the heading at one place turns the rest of the way about it, so it moves the end by the distance from
    there to the end. Systematic errors add up as vectors, spreads and noise as variances.

    Args:
        sensor: The odometry.
        legs: Straight legs of the way, world frame.
        heading: Heading at the start [rad]; None for a drive that never turns.
    """
    end = legs[-1][1]
    levers = [(_lever(a, end), _lever(b, end)) for a, b in legs]  # from both ends of each leg to the end of the way
    lengths = [math.dist(a, b) for a, b in legs]
    turns = [0.0] * len(legs) if heading is None else _turns(legs, lengths, heading)
    whole = _lever(legs[0][0], end)
    swung = _sum([(-turn * y, turn * x) for turn, ((x, y), _) in zip(turns, levers, strict=True)])
    halves = [
        0.0 if heading is None else length / 2 for length in lengths
    ]  # unequal wheels turn none that goes sideways
    bent = _sum([(-(a[1] + b[1]) * half, (a[0] + b[0]) * half) for half, (a, b) in zip(halves, levers, strict=True)])
    moved = {  # where the end goes per unit of an error [m]
        "diameter": (-bent[0] / sensor.track, -bent[1] / sensor.track),
        "track": swung,
        "scale": (-whole[0] - swung[0], -whole[1] - swung[1]),
    }
    parts: dict[str, float] = {}
    for name, vector in moved.items():
        for key in (f"{name}_error", f"{name}_std"):
            parts[key] = abs(getattr(sensor, key)) * math.hypot(*vector)
    errors = [(getattr(sensor, f"{name}_error"), vector) for name, vector in moved.items()]
    systematic = _sum([(error * x, error * y) for error, (x, y) in errors])
    squares = sum(length * _mean_square(a, b) for length, (a, b) in zip(lengths, levers, strict=True))
    kicks = sum(abs(turn) * (a[0] ** 2 + a[1] ** 2) for turn, (a, _) in zip(turns, levers, strict=True))
    parts["distance_noise"] = sensor.distance_noise * math.sqrt(sum(lengths))
    parts["heading_noise"] = sensor.heading_noise * math.sqrt(squares)
    parts["turning_noise"] = sensor.turning_noise * math.sqrt(kicks)
    random = [value for key, value in parts.items() if not key.endswith("_error")]
    return Drift(math.hypot(*systematic, *random), {key: value for key, value in parts.items() if value > 0})


def _lever(start: Point, end: Point) -> Point:
    return end[0] - start[0], end[1] - start[1]


def _sum(vectors: Sequence[Point]) -> Point:
    return math.fsum(x for x, _ in vectors), math.fsum(y for _, y in vectors)


def _mean_square(a: Point, b: Point) -> float:
    """Mean square of the vectors between two [m^2]."""
    return (a[0] ** 2 + a[0] * b[0] + b[0] ** 2 + a[1] ** 2 + a[1] * b[1] + b[1] ** 2) / 3


def _turns(legs: Sequence[tuple[Point, Point]], lengths: Sequence[float], heading: float) -> list[float]:
    """Turn before each leg [rad]."""
    turns = []
    for ((ax, ay), (bx, by)), length in zip(legs, lengths, strict=True):
        towards = math.atan2(by - ay, bx - ax) if length > 0 else heading
        turns.append(wrap(towards - heading))
        heading = towards
    return turns
