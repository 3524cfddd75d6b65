"""``static``: no drive at all."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from irsim.components.options import KinematicsOptions
from irsim.options.registry import KINEMATICS
from irsim.options.units import Number


class Static(KinematicsOptions):
    """No drive: the object never moves by itself, as without `kinematics`."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "static"}]}

    name: Literal["static"] = "static"
    alpha: list[Number] = []
    """Accepted and ignored, because a static object has no motion noise."""


@KINEMATICS.register(Static)
def stay(pose: Any, control: Any, dt: float) -> Any:
    """The pose after one period, which is unchanged."""
    return pose
