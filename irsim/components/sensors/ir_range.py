"""``ir_range``: the distance to the nearest surface in a narrow cone that returns light."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

import irsim._core as core
from irsim.components.sensors._cones import ConeOptions, Length
from irsim.components.sensors._devices import INFRARED, with_card
from irsim.options.registry import SENSORS
from irsim.options.units import Bool, Meters, Radians


class IrRange(ConeOptions):
    """Infrared range sensor with a narrow cone. Its light passes glass that it does not meet from ahead.

    Sensors that triangulate are not monotonic (`folds`): nearer than `range_min` they read a larger distance than it
    is, and nothing in the reading tells. It reads `range`, `valid` and `field_of_view`.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "ir_range", "device": "gp2y0a21", "offset": [0.2, 0.0, 0.0]}]
    }

    name: Literal["ir_range"] = "ir_range"
    device: Literal["gp2y0a21", "vl53l0x"] | None = None
    """A sensor that one can buy: cone, ranges and kind of its card; keys beside it win."""
    range_min: Length = 0.1
    """Shortest range that it measures; see `folds` for nearer surfaces."""
    range_max: Annotated[Meters, Field(gt=0)] = 0.8
    """Greatest range; without an echo the sensor reads this value, which is not valid."""
    cone: Annotated[Radians, Field(ge=0, le=3)] = 0.05
    """Full angle of the cone; 0 is a line."""
    folds: Bool = True
    """Whether a surface nearer than `range_min` reads `range_min`² / range, which is farther than it is, as of sensors
    that triangulate. With false it reads `range_min` and is not valid."""

    @model_validator(mode="before")
    @classmethod
    def _take_device(cls, given: Any) -> Any:
        return with_card(given, INFRARED)


SENSORS.register(IrRange, kernel=core.IrRangeOptions)
