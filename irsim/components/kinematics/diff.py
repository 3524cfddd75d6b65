"""``diff``: differential drive."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import KinematicsOptions
from irsim.options.registry import KINEMATICS
from irsim.options.units import Number


class Diff(KinematicsOptions):
    """Differential drive: controls are forward speed and yaw rate.

    In each step it drives straight ahead and then turns, or it drives the arc of its control: see `world.integration`.
    """

    speeds: ClassVar[int] = 1

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "diff"}]}

    name: Literal["diff"] = "diff"
    alpha: Annotated[list[Annotated[Number, Field(ge=0)]], Field(min_length=4, max_length=4)] = [0.03, 0.0, 0.0, 0.03]
    """Noise variances: linear from v², linear from ω², angular from v², angular from ω²."""


KINEMATICS.register(Diff, kernel=core.DiffOptions)
