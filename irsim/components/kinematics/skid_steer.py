"""``skid_steer``: tracks or wheels that slide sideways when the body turns."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

import irsim._core as core
from irsim.components.kinematics._presets import SKID_STEER, SURFACES, Surface, filled
from irsim.components.options import KinematicsOptions
from irsim.options.registry import KINEMATICS
from irsim.options.units import Meters, MetersPerSecond, Number


class SkidSteer(KinematicsOptions):
    """Skid steering, as of tanks and four-wheeled robots: controls are forward speed and yaw rate, as of `diff`.

    The controller turns them into speeds of the left and the right side, with the distance `believed_track`. On the
    ground each side rolls about an instantaneous centre of rotation (ICR) of its own, which lies outside the wheels:
    the body turns less than the wheels' distance says, and slides sideways where it turns ahead of the reference point.
    Change the centres or the traction to let it drive on a ground for which its controller is not calibrated: half the
    traction on one side bends a straight way. `surface` fills in these keys for a ground, and `surface` of a zone holds
    for each side that is on it. The fourth and fifth state rows are the speeds of the left and the right side.
    """

    state_rows: ClassVar[tuple[str, ...]] = ("x", "y", "theta", "left", "right")
    speeds: ClassVar[int] = 1
    slips: ClassVar[bool] = True
    feels: ClassVar[tuple[str, ...]] = ("slip", "surface")

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
    track: Annotated[Meters, Field(gt=0)] | None = None
    """Distance of both sides, where they touch the ground; null takes it from the preset."""
    surface: Surface | None = None
    """Ground whose numbers the keys of ICRs and tractions have that are not given: their distance as a multiple of
    `track`. The controller stays calibrated for `believed_track`. Null takes the ICRs from the preset."""

    @model_validator(mode="before")
    @classmethod
    def _fill(cls, data: Any) -> Any:
        full = filled(data, "preset", "p3at", SKID_STEER)
        if not isinstance(full, Mapping) or full is data or not isinstance(full["track"], (int, float)):
            return full
        name = full.get("surface")
        if not isinstance(name, str) or name not in SURFACES:
            return full
        spread, traction = SURFACES[name].values["spread"], SURFACES[name].values["traction"]
        ground = {"icr_left": 0.5 * spread * full["track"], "icr_right": -0.5 * spread * full["track"],
                  "traction_left": traction, "traction_right": traction}  # fmt: skip
        return {**full, **{key: value for key, value in ground.items() if data.get(key) is None}}


KINEMATICS.register(SkidSteer, kernel=core.SkidSteerOptions)
