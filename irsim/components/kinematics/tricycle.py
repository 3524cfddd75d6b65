"""``tricycle``: one steered and driven front wheel."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import KinematicsOptions
from irsim.options.colors import ACKER_COLOR, OBSTACLE_COLOR
from irsim.options.registry import KINEMATICS
from irsim.options.units import Number, Radians, RadiansPerSecond, RadiansPerSecondSquared, Seconds


class Tricycle(KinematicsOptions):
    """Tricycle: controls are the speed of its steered, driven front wheel and the steering angle, or its rate.

    The body drives ahead with the wheel's speed times the cosine of the angle and turns with that speed times the sine,
    over the wheelbase: at a quarter turn it turns on the spot. The reference point is the middle of the rear axle; a
    missing wheelbase counts as 1 m. Forklifts and many carts are of this kind. Without a limit the angle changes at the
    end of the step, as for `acker`; with `steer_rate`, `steer_acce` or `steer_lag` it changes during the step.
    """

    state_rows: ClassVar[tuple[str, ...]] = ("x", "y", "theta", "steer", "steer_speed")
    control_rows: ClassVar[tuple[str, ...]] = ("linear", "steer")
    control_units: ClassVar[tuple[str, ...]] = ("m/s", "rad or rad/s")
    speeds: ClassVar[int] = 1
    feels: ClassVar[tuple[str, ...]] = ("slip",)
    steered: ClassVar[bool] = True
    pivots: ClassVar[bool] = True
    usual_vel_max: ClassVar[tuple[float, ...]] = (1.0, math.pi / 2)
    usual_vel_min: ClassVar[tuple[float, ...]] = (-1.0, -math.pi / 2)
    usual_colors: ClassVar[tuple[str, str] | None] = (ACKER_COLOR, OBSTACLE_COLOR)

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "tricycle", "wheelbase": 1.2, "steer_rate": 1.5}]}

    name: Literal["tricycle"] = "tricycle"
    alpha: Annotated[list[Annotated[Number, Field(ge=0)]], Field(min_length=4, max_length=4)] = [0.03, 0.0, 0.0, 0.03]
    """Noise variances: wheel speed from v², from the second control², second control from v², from itself²."""
    mode: Literal["steer", "angular"] = "steer"
    """Second control: `steer` is the steering angle, `angular` the rate at which it changes."""
    psi_max: Annotated[Radians, Field(gt=0, le=math.pi / 2)] = math.pi / 2
    """Largest steering angle, at most a quarter turn."""
    steer_rate: Annotated[RadiansPerSecond, Field(gt=0)] | None = None
    """Largest rate of the steering angle; null is unlimited."""
    steer_acce: Annotated[RadiansPerSecondSquared, Field(gt=0)] | None = None
    """Largest change of that rate; null is unlimited."""
    steer_lag: Annotated[Seconds, Field(ge=0)] = 0.0
    """Time constant with which the angle approaches the commanded one; in mode `angular` the rate its own."""

    def steering(self, low: Sequence[float], high: Sequence[float]) -> tuple[float, float]:
        """Largest steering angles to the right and to the left [rad]."""
        if self.mode == "angular":  # there the second control is the rate at which the angle changes
            return self.psi_max, self.psi_max
        right, left = super().steering(low, high)
        return min(right, self.psi_max), min(left, self.psi_max)


KINEMATICS.register(Tricycle, kernel=core.TricycleOptions)
