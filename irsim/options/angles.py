"""Angles of at most a full turn, as sensors and fields of view take them."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import AfterValidator, Field

from irsim.common.angles import FULL_TURN
from irsim.options.base import problem
from irsim.options.units import Radians

__all__ = ["SpanAngle", "is_span"]

_ROUNDING = 0.02
"""Excess over a full turn that counts as rounding: 6.28, 6.2832 and 6.3 all mean a full turn [rad]."""


def is_span(angle: float) -> bool:
    """Whether an opening angle is at most a full turn, apart from rounding."""
    return angle <= FULL_TURN + _ROUNDING


def _clip(angle: float) -> float:
    if not is_span(angle):
        radians = min(round(math.radians(angle), 9), FULL_TURN) if 10 <= angle <= 360 else None
        degrees = "" if radians is None else f"; {angle:g} degrees are {radians:.5g} rad"
        raise problem(
            "angle-over-full-turn",
            f"{angle:g} rad is more than a full turn",
            allowed="0 to 6.28318 (2π) radians",
            fix=f"angles are in radians: a full turn is 6.28318{degrees}",
            replace=radians,
            tolerated_as=FULL_TURN,
        )
    return min(angle, FULL_TURN)


SpanAngle = Annotated[
    Radians,
    Field(ge=0),
    AfterValidator(_clip),
    Field(json_schema_extra={"maximum": round(FULL_TURN + _ROUNDING, 4)}),
]
"""An opening angle from 0 to a full turn."""
