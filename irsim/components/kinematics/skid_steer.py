"""``skid_steer``: tracks or wheels that slide sideways when the body turns."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

import irsim._core as core
from irsim.components.kinematics._presets import SKID_STEER, filled
from irsim.components.options import KinematicsOptions
from irsim.options.registry import KINEMATICS
from irsim.options.units import Meters, MetersPerSecond, Number


class SkidSteer(KinematicsOptions):
    """Skid steering, as of tanks and four-wheeled robots: controls are forward speed and yaw rate, as of `diff`.

    The controller turns them into speeds of the left and the right side, with the distance `believed_track`. On the
    ground each side rolls about an instantaneous centre of rotation (ICR) of its own, which lies outside the wheels:
    the body turns less than the wheels' distance says, and slides sideways where it turns ahead of the reference point.
    Change the centres or the traction to let it drive on a ground for which its controller is not calibrated: half the
    traction on one side bends a straight way. The fourth and fifth state rows are the speeds of the left and the right
    side. Zones do not change the ground yet.
    """

    state_rows: ClassVar[tuple[str, ...]] = ("x", "y", "theta", "left", "right")
    speeds: ClassVar[int] = 1
    slips: ClassVar[bool] = True

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "skid_steer", "preset": "husky", "icr_ahead": 0.1}]}

    name: Literal["skid_steer"] = "skid_steer"
    alpha: Annotated[list[Annotated[Number, Field(ge=0)]], Field(min_length=4, max_length=4)] = [0.03, 0.0, 0.0, 0.03]
    """Noise variances: linear from v², linear from ω², angular from v², angular from ω²."""
    preset: Literal["p3at", "jackal", "husky"] = "p3at"
    """Robot whose numbers the keys below have that are not given: Pioneer 3-AT as measured (Wang et al., Sensors 2015),
    Jackal and Husky as their maker calibrates them."""
    believed_track: Annotated[Meters, Field(gt=0)] | None = None
    """Distance of both sides with which the controller works; null takes it from the preset."""
    icr_left: Annotated[Meters, Field(gt=0)] | None = None
    """Where the left side has its ICR, to the left of the reference point; null takes it from the preset."""
    icr_right: Annotated[Meters, Field(lt=0)] | None = None
    """The same of the right side, a negative number."""
    icr_ahead: Meters = 0.0
    """How far ahead of the reference point the body turns; negative behind it."""
    traction_left: Annotated[Number, Field(gt=0, le=2)] = 1.0
    """Speed over ground per speed of the left side: 0.9 is a slip of 10 %."""
    traction_right: Annotated[Number, Field(gt=0, le=2)] = 1.0
    """The same of the right side."""
    speed_max: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Largest speed of a side; faster commands are slowed in proportion. Null is unlimited."""

    @model_validator(mode="before")
    @classmethod
    def _fill(cls, data: Any) -> Any:
        return filled(data, "preset", "p3at", SKID_STEER)


KINEMATICS.register(SkidSteer, kernel=core.SkidSteerOptions)
