"""``diff``: differential drive."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import KinematicsOptions
from irsim.options.registry import KINEMATICS
from irsim.options.units import Meters, Number


class Diff(KinematicsOptions):
    """Differential drive: controls are forward speed and yaw rate.

    In each step it drives straight ahead and then turns, or it drives the arc of its control: see `world.integration`.
    """

    speeds: ClassVar[int] = 1
    feels: ClassVar[tuple[str, ...]] = ("slip",)

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "diff"}]}

    name: Literal["diff"] = "diff"
    alpha: Annotated[list[Annotated[Number, Field(ge=0)]], Field(min_length=4, max_length=4)] = [0.03, 0.0, 0.0, 0.03]
    """Noise variances: linear from v², linear from ω², angular from v², angular from ω²."""
    track: Annotated[Meters, Field(gt=0)] | None = None
    """Distance of the wheels, which says on which `world.zones` with `slip` each wheel is and how the body turns where
    one slips more; null is the width of the body."""


KINEMATICS.register(Diff, kernel=core.DiffOptions)
