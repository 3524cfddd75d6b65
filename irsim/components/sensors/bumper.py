"""``bumper``: sectors of the hull that press against something."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

import irsim._core as core
from irsim.components.sensors._gauges import GaugeOptions
from irsim.options.base import problem
from irsim.options.registry import SENSORS
from irsim.options.units import Meters
from irsim.options.vectors import Range


class Bumper(GaugeOptions):
    """Bumper: sectors of the hull, each of which is pressed while it touches anything that obstructs.

    It reads `pressed_0`, `pressed_1`, … in the order of `sectors`, each 0 or 1, in any `collision_mode`.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "bumper", "sectors": [[-1.2, -0.4], [-0.4, 0.4], [0.4, 1.2]]}]
    }

    name: Literal["bumper"] = "bumper"
    sectors: Annotated[list[Range], Field(min_length=1, max_length=100)] = [[-1.5708, 0.0], [0.0, 1.5708]]
    """First and last bearing of each sector, about the origin of the body: 0 is ahead, positive to the left. By default
    the right and the left half of the front."""
    reach: Annotated[Meters, Field(ge=0, le=1)] = 0.002
    """Surfaces nearer to the hull than this press it."""

    @model_validator(mode="after")
    def _check(self) -> Bumper:
        for first, last in self.sectors:
            if not first < last <= first + 2 * math.pi + 1e-4:
                raise problem(
                    "range-order",
                    f"a sector goes from a bearing to a greater one, got [{first:g}, {last:g}]",
                    allowed="first < last, at most a full turn apart",
                    fix=f"sectors: [[{min(first, last):g}, {max(first, last):g}]]"
                    if first != last
                    else f"sectors: [[{first:g}, {first + 1:g}]]",
                )
        return self

    def numbers(self) -> tuple[tuple[str, str], ...]:
        """Name and unit of each of its numbers: one for each sector."""
        return tuple((f"pressed_{k}", "1") for k in range(len(self.sectors)))


SENSORS.register(Bumper, kernel=core.BumperOptions)
