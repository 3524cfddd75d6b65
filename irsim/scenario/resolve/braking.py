"""How long and how far an object brakes from its top speed, and horizons of behaviors that are longer than that."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from irsim.scenario.resolve.body_size import top_speed
from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["Braking", "braking_of", "follow_text", "horizons_that_work", "short_horizons"]

HORIZONS = ("timeHorizon", "timeHorizonObst")
"""Keys of behaviors: time horizons for what moves, and for what stands [s]."""
_ROOM = 1.5
"""Times the braking time that a horizon covers which is proposed: it leaves time to decide before braking."""


class Braking(NamedTuple):
    """An object brakes from its top speed.

    Attributes:
        speed: Top speed [m/s].
        acce: Largest change of speed [m/s^2].
        time: Time until it stands [s].
        distance: Distance until it stands [m].
    """

    speed: float
    acce: float
    time: float
    distance: float


def braking_of(record: ObjectRecord) -> Braking | None:
    """How an object brakes; None if it stops at once, or does not drive."""
    travel = max(1, getattr(record.kinematics, "speeds", 1))
    limits = [float(limit) for limit in record.acce[:travel] if 0 < limit < math.inf]
    if not limits:
        return None
    options: Any = record.active_behavior
    most = getattr(getattr(options, "local", options), "maxSpeed", None)
    speed = top_speed(record) if most is None else min(top_speed(record), most)
    if not 0 < speed < math.inf:
        return None
    acce = min(limits)
    return Braking(speed, acce, speed / acce, speed * speed / (2 * acce))


def short_horizons(options: Any, braking: Braking) -> list[str]:
    """Keys of a behavior's horizons that are shorter than the braking time."""
    return [key for key in HORIZONS if getattr(options, key, math.inf) < braking.time]


def follow_text(record: ObjectRecord) -> str:
    """The behavior ``follow`` with the present behavior of an object as its local one, and horizons that work."""
    options: Any = record.active_behavior
    braking = braking_of(record)
    named = hasattr(options, "timeHorizon") and braking is not None
    horizon = f", timeHorizon: {horizons_that_work(braking):g}" if named and braking is not None else ""
    return f"behavior: {{name: follow, local: {{name: {options.name}{horizon}}}}}"


def horizons_that_work(braking: Braking) -> float:
    """A horizon with which the object sees what is ahead before it must brake [s], to a tenth of a second."""
    return math.ceil(10 * _ROOM * braking.time - 1e-9) / 10
