"""Names that IR-SIM scripts import from ``irsim.lib``; plain re-exports, imported when first used."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from irsim.lib.behavior.behavior_registry import (
    register_behavior,
    register_behavior_class,
    register_group_behavior,
    register_group_behavior_class,
)

_PLANNERS = "irsim.lib.path_planners"
_HOMES = {
    "AStarPlanner": _PLANNERS,
    "InformedRRTStar": _PLANNERS,
    "JPSPlanner": _PLANNERS,
    "KinematicsFactory": "irsim.lib.handler.kinematics_handler",
    "KinematicsHandler": "irsim.kinematics._handler",
    "PRMPlanner": _PLANNERS,
    "RRT": _PLANNERS,
    "RRTStar": _PLANNERS,
    "ackermann_kinematics": "irsim.lib.algorithm.kinematics",
    "differential_kinematics": "irsim.lib.algorithm.kinematics",
    "omni_kinematics": "irsim.lib.algorithm.kinematics",
    "register_kinematics": "irsim.kinematics._handler",
}

__all__ = [
    "RRT",
    "AStarPlanner",
    "InformedRRTStar",
    "JPSPlanner",
    "KinematicsFactory",
    "KinematicsHandler",
    "PRMPlanner",
    "RRTStar",
    "ackermann_kinematics",
    "differential_kinematics",
    "kinematics_factory",
    "omni_kinematics",
    "register_behavior",
    "register_behavior_class",
    "register_group_behavior",
    "register_group_behavior_class",
    "register_kinematics",
]


def __getattr__(name: str) -> Any:
    if name == "kinematics_factory":
        from irsim.lib.algorithm import kinematics

        value: Any = {
            "diff": kinematics.differential_kinematics,
            "acker": kinematics.ackermann_kinematics,
            "omni": kinematics.omni_kinematics,
        }
    elif name in _HOMES:
        value = getattr(import_module(_HOMES[name]), name)
    else:
        raise AttributeError(f"module 'irsim.lib' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
