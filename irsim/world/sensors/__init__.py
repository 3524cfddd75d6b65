"""Sensors under the names of IR-SIM."""

from __future__ import annotations

from typing import Any

from irsim._names import from_homes

__all__ = ["Contact2D", "FMCWLidar2D", "Lidar2D", "SensorFactory"]

_get = from_homes(
    __name__,
    {
        "Contact2D": "irsim.contacts",
        "FMCWLidar2D": "irsim.scans",
        "Lidar2D": "irsim.scans",
        "SensorFactory": "irsim.sensor_factory",
    },
)


def __getattr__(name: str) -> Any:
    return _get(name)
