"""``single_track``: a car as one wheel in front and one behind, with tyres that slip."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

import irsim._core as core
from irsim.components.kinematics._presets import VEHICLES, filled
from irsim.components.options import KinematicsOptions
from irsim.options.colors import ACKER_COLOR, OBSTACLE_COLOR
from irsim.options.registry import KINEMATICS
from irsim.options.units import Meters, MetersPerSecond, MetersPerSecondSquared, Number, Radians, RadiansPerSecond

Positive = Annotated[Number, Field(ge=1e-6, le=1e9)]
CarLength = Annotated[Meters, Field(ge=0.01, le=100)]
"""Lengths of cars, from toys to trains: with others the yaw rate leaves the range of numbers."""


class SingleTrack(KinematicsOptions):
    """Car with mass: controls are speed and steering angle, which it follows as fast as its engine and wheels can.

    These are the kinematic and the dynamic single-track model of CommonRoad (Althoff and Würsching, 2020). With
    `model: dynamic` the car has a yaw rate and a slip angle of its own: it understeers at speed, and skids where its
    tyres give no more force. Below 0.5 m/s and backward the wheels roll where they point, and up to 1 m/s both models
    are blended. The reference point is the middle of the rear axle. Each step is integrated in parts of at most 10 ms,
    whatever `world.integration`, and is stable from rest to top speed. State rows four to seven are steering angle,
    speed, yaw rate and slip angle at the centre of mass. `vel_max` still limits the commands: set it for more than
    1 m/s. Contacts cannot push it.
    """

    state_rows: ClassVar[tuple[str, ...]] = ("x", "y", "theta", "steer", "speed", "yaw_rate", "slip")
    control_rows: ClassVar[tuple[str, ...]] = ("linear", "steer")
    control_units: ClassVar[tuple[str, ...]] = ("m/s", "rad or rad/s")
    speeds: ClassVar[int] = 1
    steered: ClassVar[bool] = True
    slips: ClassVar[bool] = True
    feels: ClassVar[tuple[str, ...]] = ("slip", "grip")
    coasts: ClassVar[bool] = True
    usual_acce: ClassVar[tuple[float, ...]] = (4.0, math.inf)
    usual_colors: ClassVar[tuple[str, str] | None] = (ACKER_COLOR, OBSTACLE_COLOR)
    picture: ClassVar[str | None] = "car_green.png"

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "single_track", "vehicle": "f1tenth"}, {"name": "single_track", "model": "kinematic"}]
    }

    name: Literal["single_track"] = "single_track"
    alpha: Annotated[list[Annotated[Number, Field(ge=0)]], Field(min_length=4, max_length=4)] = [0.03, 0.0, 0.0, 0.03]
    """Noise variances: first control from itself², from the second control², second from the first², from itself²."""
    model: Literal["kinematic", "dynamic"] = "dynamic"
    """`kinematic`: wheels roll where they point, at any speed. `dynamic`: tyres slip."""
    vehicle: Literal["ford_escort", "bmw_320i", "vw_vanagon", "f1tenth"] = "f1tenth"
    """Car whose numbers the keys below have that are not given: three of CommonRoad, and F1TENTH, 0.58 m long."""
    tyres: Literal["saturating", "linear"] = "saturating"
    """`saturating`: their force ends at friction times load. `linear`: it grows with the slip for ever, as in
    CommonRoad."""
    mode: Literal["steer", "angular", "acceleration"] = "steer"
    """Controls: speed and steering angle (`steer`), speed and its rate (`angular`), or as in CommonRoad acceleration
    and that rate (`acceleration`), for policies and programs: behaviors give speeds."""
    wheelbase: CarLength | None = None
    """Distance between the axles; null is `front` plus `rear`, which another number stretches."""
    psi_max: Annotated[Radians, Field(gt=0, lt=math.pi / 2)] | None = None
    """Largest steering angle."""
    steer_rate: Annotated[RadiansPerSecond, Field(gt=0)] | None = None
    """Largest rate of the steering angle."""
    acce_max: Annotated[MetersPerSecondSquared, Field(gt=0)] | None = None
    """Largest acceleration, and deceleration."""
    speed_switch: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Speed above which the engine's power limits the acceleration."""
    speed_min: Annotated[MetersPerSecond, Field(le=0)] | None = None
    """Fastest speed backward, a negative number."""
    speed_max: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Fastest speed forward."""
    mass: Positive | None = None
    """Mass [kg]."""
    inertia: Positive | None = None
    """Moment of inertia about the vertical axis [kg m²]."""
    front: CarLength | None = None
    """Distance of the front axle from the centre of mass."""
    rear: CarLength | None = None
    """Distance of the rear axle from the centre of mass."""
    height: Annotated[Meters, Field(ge=0)] | None = None
    """Height of the centre of mass, for the load that braking shifts."""
    friction: Positive | None = None
    """Coefficient of friction of the tyres; `grip` of a zone changes it, and the largest acceleration with it."""
    stiffness_front: Positive | None = None
    """Cornering stiffness of the front tyres per load [1/rad]."""
    stiffness_rear: Positive | None = None
    """The same of the rear tyres."""

    @model_validator(mode="before")
    @classmethod
    def _fill(cls, data: Any) -> Any:
        full = filled(data, "vehicle", "f1tenth", VEHICLES)
        if not isinstance(full, Mapping) or full is data:
            return data
        front, rear, base = full["front"], full["rear"], full.get("wheelbase")
        if not isinstance(front, (int, float)) or not isinstance(rear, (int, float)):
            return full
        if not isinstance(base, (int, float)) or not base > 0:
            return {**full, "wheelbase": front + rear} if base is None else full
        scale = base / (front + rear)
        return {**full, "front": front * scale, "rear": rear * scale}

    def steering(self, low: Sequence[float], high: Sequence[float]) -> tuple[float, float]:
        """Largest steering angles to the right and to the left [rad]."""
        most = math.inf if self.psi_max is None else self.psi_max
        if self.mode != "steer":  # there the second control is the rate at which the angle changes
            return most, most
        right, left = super().steering(low, high)
        return min(right, most), min(left, most)


KINEMATICS.register(SingleTrack, kernel=core.SingleTrackOptions)
