"""``acker``: car-like steering."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import KinematicsOptions
from irsim.options.colors import ACKER_COLOR, OBSTACLE_COLOR
from irsim.options.registry import KINEMATICS
from irsim.options.units import Number, Radians


class Acker(KinematicsOptions):
    """Ackermann steering: controls are forward speed and steering angle, or its rate.

    The fourth state row is the steering angle. The reference point is the middle of the rear axle; a missing wheelbase
    counts as 1 m. In each step it drives straight ahead and then turns, or it drives the arc of its control: see
    `world.integration`. The steering angle changes at the end of the step, so that it acts on the next one.
    """

    state_rows: ClassVar[tuple[str, ...]] = ("x", "y", "theta", "steer")
    control_rows: ClassVar[tuple[str, ...]] = ("linear", "steer")
    control_units: ClassVar[tuple[str, ...]] = ("m/s", "rad or rad/s")
    speeds: ClassVar[int] = 1
    feels: ClassVar[tuple[str, ...]] = ("slip",)
    steered: ClassVar[bool] = True
    usual_colors: ClassVar[tuple[str, str] | None] = (ACKER_COLOR, OBSTACLE_COLOR)
    picture: ClassVar[str | None] = "car_green.png"

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "acker", "wheelbase": 3.0}]}

    name: Literal["acker"] = "acker"
    alpha: Annotated[list[Annotated[Number, Field(ge=0)]], Field(min_length=4, max_length=4)] = [0.03, 0.0, 0.0, 0.03]
    """Noise variances: linear from v², linear from the second control², second control from v², from itself²."""
    mode: Literal["steer", "angular"] = "steer"
    """Second control: `steer` is the steering angle, `angular` the rate at which it changes."""
    psi_max: Annotated[Radians, Field(gt=0)] | None = None
    """Largest steering angle; null leaves it to `vel_max` in `steer` mode and unlimited in `angular` mode, in which
    behaviors then steer up to 45 degrees. `dash` steers for mode `steer`: in the other one, `follow` arrives."""

    def steering(self, low: Sequence[float], high: Sequence[float]) -> tuple[float, float]:
        """Largest steering angles to the right and to the left [rad]; infinity without a limit."""
        most = math.inf if self.psi_max is None else self.psi_max
        if self.mode == "angular":  # there the second control is the rate at which the angle changes
            return most, most
        right, left = super().steering(low, high)
        return min(right, most), min(left, most)


KINEMATICS.register(Acker, kernel=core.AckerOptions)
