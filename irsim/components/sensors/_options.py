"""Options that all sensors have in common."""

from __future__ import annotations

from typing import ClassVar

from irsim.options.base import Options

__all__ = ["SensorOptions"]


class SensorOptions(Options):
    """A sensor on an object."""

    is_lidar: ClassVar[bool] = False
    """Whether the first such sensor becomes the object's ``lidar``."""

    name: str
    """Name of the sensor."""
    type: str | None = None
    """Another key for the name, used if `name` is missing."""
