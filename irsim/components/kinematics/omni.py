"""``omni``: moves in any direction, keeps its heading."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import KinematicsOptions
from irsim.options.registry import KINEMATICS
from irsim.options.units import Number


class Omni(KinematicsOptions):
    """Omnidirectional base without rotation: controls are forward and lateral speed in the body frame.

    Its motion is exact at any `step_time`, because it does not turn.
    """

    control_rows: ClassVar[tuple[str, ...]] = ("forward", "lateral")
    control_units: ClassVar[tuple[str, ...]] = ("m/s", "m/s")

    speeds: ClassVar[int] = 2
    feels: ClassVar[tuple[str, ...]] = ("slip",)
    turns: ClassVar[bool] = False
    arrow: ClassVar[bool] = False

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "omni"}]}

    name: Literal["omni"] = "omni"
    alpha: Annotated[list[Annotated[Number, Field(ge=0)]], Field(min_length=2, max_length=2)] = [0.03, 0.03]
    """Noise variances (m²/s²) of forward and lateral speed; they do not vanish at standstill."""


KINEMATICS.register(Omni, kernel=core.OmniOptions)
