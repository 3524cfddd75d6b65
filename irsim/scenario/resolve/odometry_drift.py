"""How far wheel odometry is off at the end of a way, in closed form, to the first order of its errors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from irsim.common.angles import wrap
from irsim.components.sensors.odometry import Odometry
from irsim.scenario.model.zones import Zone

__all__ = ["Drift", "Slippage", "drift_of"]

_PIECES = 100
"""Number of pieces of a leg; each is in the zone that its middle is in."""
_MOST_SLIP = 0.95
"""Largest slip that is counted: at 1 a robot never arrives."""

Point = tuple[float, float]


class Drift(NamedTuple):
    """Error of the believed position at the end of a way.

    Attributes:
        error: Root mean square of the distance between the believed and the true position [m].
        parts: Key of the sensor -> the error that it alone would make [m], for keys that make one; the slip of a zone
            under ``the slip of zone 'NAME'``.
    """

    error: float
    parts: Mapping[str, float]


class Slippage(NamedTuple):
    """The ground on which wheels slip, and who drives over it.

    Attributes:
        zones: The zones of the world.
        speed: Speed of the robot [m/s].
        track: Distance of wheels side by side, which slip by different shares [m]; None without such wheels.
        step_time: Period of a step [s].
    """

    zones: Sequence[Zone]
    speed: float
    track: float | None
    step_time: float

    def at(self, x: float, y: float) -> Zone | None:
        """The zone whose ground counts at a point: the last one there."""
        return next((zone for zone in reversed(self.zones) if zone.has_ground and zone.covers(x, y)), None)


def drift_of(
    sensor: Odometry,
    legs: Sequence[tuple[Point, Point]],
    heading: float | None,
    slippage: Slippage | None = None,
) -> Drift:
    """The drift along straight legs, between which the robot turns on the spot.

    An error of the heading at one place turns the rest of the way about it, so it moves the end by the distance from
    there to the end. Systematic errors add up as vectors, spreads and noise as variances. A wheel that slips by a share
    s turns by 1 / (1 - s) times its way over ground.

    Args:
        sensor: The odometry.
        legs: Straight legs of the way, world frame.
        heading: Heading at the start [rad]; None for a drive that never turns.
        slippage: The ground on which wheels slip; None where they do not.
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
    slips = {} if slippage is None else _slips(slippage, legs, lengths, turns)
    for name, (vector, wandering) in slips.items():
        errors.append((1.0, vector))
        parts[name] = math.hypot(*vector, wandering)
    systematic = _sum([(error * x, error * y) for error, (x, y) in errors])
    squares = sum(length * _mean_square(a, b) for length, (a, b) in zip(lengths, levers, strict=True))
    kicks = sum(abs(turn) * (a[0] ** 2 + a[1] ** 2) for turn, (a, _) in zip(turns, levers, strict=True))
    parts["distance_noise"] = sensor.distance_noise * math.sqrt(sum(lengths))
    parts["heading_noise"] = sensor.heading_noise * math.sqrt(squares)
    parts["turning_noise"] = sensor.turning_noise * math.sqrt(kicks)
    random = [value for key, value in parts.items() if not key.endswith("_error") and key not in slips]
    random += [wandering for _, wandering in slips.values()]
    return Drift(math.hypot(*systematic, *random), {key: value for key, value in parts.items() if value > 0})


def _slips(
    slippage: Slippage, legs: Sequence[tuple[Point, Point]], lengths: Sequence[float], turns: Sequence[float]
) -> dict[str, tuple[Point, float]]:
    """Where the slip of each zone moves the believed end, in the mean, and the deviation from there [m]."""
    end = legs[-1][1]
    moved: dict[str, list[Point]] = {}
    squares: dict[str, float] = {}
    for ((ax, ay), (bx, by)), length, turn in zip(legs, lengths, turns, strict=True):
        levers: dict[str, list[float]] = {}
        known: dict[str, Zone] = {}
        for k in range(_PIECES):
            share = (k + 0.5) / _PIECES
            x, y = ax + share * (bx - ax), ay + share * (by - ay)
            if (zone := slippage.at(x, y)) is not None:
                known[zone.name] = zone
                levers.setdefault(zone.name, []).append(math.dist((x, y), end))
        for name, zone in known.items():
            way, slip = len(levers[name]) / _PIECES, min(zone.slip, _MOST_SLIP)
            kept, lost = 1 - slip, slip / (1 - slip)
            moved.setdefault(name, []).append((-lost * way * (bx - ax), -lost * way * (by - ay)))
            span = slippage.speed * _span(zone, way * length / slippage.speed, slippage.step_time) / kept**2
            swing = 0.0
            if slippage.track is not None:
                lever = math.sqrt(sum(one**2 for one in levers[name]) / len(levers[name]))
                swing = math.sqrt(2) * span / slippage.track * lever
            squares[name] = squares.get(name, 0.0) + span**2 / 2 + swing**2
        if turn and (zone := slippage.at(ax, ay)) is not None:
            slip = min(zone.slip, _MOST_SLIP)
            lost = slip / (1 - slip)
            x, y = _lever((ax, ay), end)
            moved.setdefault(zone.name, []).append((lost * turn * y, -lost * turn * x))
    return {
        f"the slip of zone '{name}'": (_sum(vectors), math.sqrt(squares.get(name, 0.0)))
        for name, vectors in moved.items()
    }


def _span(zone: Zone, time: float, step_time: float) -> float:
    """Standard deviation of the integral of the slip of a wheel over a time [s]: of an AR(1) process."""
    if zone.slip_time <= 0:
        return zone.slip_std * math.sqrt(time * step_time)
    lasting = zone.slip_time * (1 - math.exp(-time / zone.slip_time))
    return zone.slip_std * math.sqrt(max(0.0, 2 * zone.slip_time * (time - lasting)))


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
