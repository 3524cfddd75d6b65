"""The sensor ``beacons``: distance and bearing of all objects tagged ``beacon`` within reach, with optional noise."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from irsim.plugins import SENSORS, Meters, SensorOptions


class Beacons(SensorOptions):
    """Measures distance and bearing of objects tagged `beacon`, through walls, as radio does."""

    name: Literal["beacons"] = "beacons"
    reach: Annotated[Meters, Field(gt=0)] = 5.0
    """Greatest distance at which a beacon is heard."""
    std: Annotated[Meters, Field(ge=0)] = 0.0
    """Standard deviation of the measured distance."""


@SENSORS.register(Beacons)
def beacons(parent: Any, options: Beacons, rng: np.random.Generator) -> dict[str, tuple[float, float]]:
    """Return distance [m] and bearing [rad, body frame] of each beacon by its name."""
    x, y, heading = parent.state[:3, 0]
    heard = {}
    for other in parent.environment_objects:
        if "beacon" not in other.tags:
            continue
        dx, dy = other.state[0, 0] - x, other.state[1, 0] - y
        distance = math.hypot(dx, dy)
        if distance <= options.reach:
            noise = options.std * rng.standard_normal()
            heard[other.name] = (distance + noise, math.remainder(math.atan2(dy, dx) - heading, math.tau))
    return heard
