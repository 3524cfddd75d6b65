"""What sensor options have in common."""

from __future__ import annotations

from typing import ClassVar

from irsim.options.base import Options

__all__ = ["SensorOptions"]


class SensorOptions(Options):
    """A sensor on an object."""

    is_lidar: ClassVar[bool] = False
    """Whether the first such sensor becomes the object's ``lidar``."""

    name: str
    """Which sensor."""
    type: str | None = None
    """Another word for `name`, used where `name` is missing."""
