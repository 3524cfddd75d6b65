"""Sensors under the names of IR-SIM."""

from __future__ import annotations

from typing import Any

__all__ = ["Contact2D", "FMCWLidar2D", "Lidar2D", "SensorFactory"]

_HOMES = {
    "Contact2D": "irsim.contacts",
    "FMCWLidar2D": "irsim.scans",
    "Lidar2D": "irsim.scans",
    "SensorFactory": "irsim.sensor_factory",
}


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
