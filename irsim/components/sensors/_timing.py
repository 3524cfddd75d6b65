"""When sensors measure, and when their data arrive: keys that lidars and gauges have."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from irsim.components.options import SensorOptions
from irsim.options.units import Hertz, Seconds

__all__ = ["MOST_LATENCY", "TimedOptions"]

MOST_LATENCY = 10.0
"""Longest latency [s]; data on their way take memory."""


class TimedOptions(SensorOptions):
    """A sensor that measures in each step, or at a rate, and whose data arrive at once, or late."""

    also_called: ClassVar[dict[str, str]] = {
        "frequency": "rate",
        "hz": "rate",
        "update_rate": "rate",
        "sample_rate": "rate",
        "delay": "latency",
        "lag": "latency",
    }

    rate: Annotated[Hertz, Field(gt=0)] | None = None
    """Measurements per second; null is one in each step, which is also the most. Measurement k is taken in the first
    step that ends at k / rate or later; until the next one programs read the last data."""
    latency: Annotated[Seconds, Field(ge=0, le=MOST_LATENCY)] = 0.0
    """Time from a measurement to the first step in which programs read it. Before the first data of an episode lidars
    read as without a hit, and numbers are NaN."""

    @property
    def is_timed(self) -> bool:
        """Whether what programs read may be old."""
        return self.rate is not None or self.latency > 0
