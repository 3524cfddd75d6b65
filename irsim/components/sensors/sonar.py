"""``sonar``: the distance to the nearest surface in a cone that returns sound."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from pydantic import model_validator

import irsim._core as core
from irsim.components.sensors._cones import ConeOptions, Share
from irsim.components.sensors._devices import SONARS, with_card
from irsim.options.registry import SENSORS


class Sonar(ConeOptions):
    """Sonar: the distance to the nearest surface in a cone. Glass and mirrors return sound as walls do.

    It reads `range`, `valid` (1 with an echo within the limits) and `field_of_view`, as the message Range of ROS does.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "sonar", "device": "hc_sr04", "offset": [0.2, 0.0, 0.0]}]
    }

    name: Literal["sonar"] = "sonar"
    device: Literal["hc_sr04"] | None = None
    """A sonar that one can buy: cone, ranges and noise of its card; keys beside it win."""
    crosstalk: Share = 0.0
    """Share of readings in which another sonar is heard: at any range, if that is before its own echo."""

    @model_validator(mode="before")
    @classmethod
    def _take_device(cls, given: Any) -> Any:
        return with_card(given, SONARS)


SENSORS.register(Sonar, kernel=core.SonarOptions)
