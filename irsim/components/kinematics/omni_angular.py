"""``omni_angular``: moves in any direction and turns."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import KinematicsOptions
from irsim.options.registry import KINEMATICS
from irsim.options.units import Number


class OmniAngular(KinematicsOptions):
    """Omnidirectional base with rotation: controls are forward and lateral speed in the body frame, and yaw rate.

    In each step it drives straight and then turns, or it drives the arc of its control: see `world.integration`.

    With `dash` it turns its front to the goal while it drives, and at the goal to the heading that the goal gives.
    """

    control_rows: ClassVar[tuple[str, ...]] = ("forward", "lateral", "yaw_rate")
    control_units: ClassVar[tuple[str, ...]] = ("m/s", "m/s", "rad/s")

    speeds: ClassVar[int] = 2
    feels: ClassVar[tuple[str, ...]] = ("slip",)

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "omni_angular"}]}

    name: Literal["omni_angular"] = "omni_angular"
    alpha: Annotated[list[Annotated[Number, Field(ge=0)]], Field(min_length=3, max_length=3)] = [0.03, 0.03, 0.03]
    """Noise variances of forward speed, lateral speed and yaw rate; they do not vanish at standstill."""


KINEMATICS.register(OmniAngular, kernel=core.OmniAngularOptions)
