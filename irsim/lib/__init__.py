"""Names that IR-SIM scripts import from ``irsim.lib``; plain re-exports, imported when first used."""

from __future__ import annotations

from typing import Any

from irsim._names import from_homes
from irsim.lib.behavior.behavior_registry import (
    register_behavior,
    register_behavior_class,
    register_group_behavior,
    register_group_behavior_class,
)

_ALGORITHM = "irsim.lib.algorithm"
_PLANNERS = "irsim.lib.path_planners"
_HOMES = {
    "AStarPlanner": _PLANNERS,
    "Behavior": "irsim.lib.behavior.behavior",
    "GeometryFactory": "irsim.lib.handler.geometry_handler",
    "GroupBehavior": "irsim.lib.behavior.group_behavior",
    "InformedRRTStar": _PLANNERS,
    "JPSPlanner": _PLANNERS,
    "KinematicsFactory": "irsim.lib.handler.kinematics_handler",
    "KinematicsHandler": "irsim.kinematics._handler",
    "PRMPlanner": _PLANNERS,
    "RRT": _PLANNERS,
    "RRTStar": _PLANNERS,
    "SocialForceModelBatch": _ALGORITHM,
    "ackermann_kinematics": _ALGORITHM,
    "contact_step": "irsim.contacts",
    "differential_kinematics": _ALGORITHM,
    "generate_polygon": _ALGORITHM,
    "omni_kinematics": _ALGORITHM,
    "random_generate_polygon": _ALGORITHM,
    "reciprocal_vel_obs": _ALGORITHM,
    "register_kinematics": "irsim.kinematics._handler",
    "social_force_model": _ALGORITHM,
}
_get = from_homes(__name__, _HOMES)

__all__ = [
    "RRT",
    "AStarPlanner",
    "Behavior",
    "GeometryFactory",
    "GroupBehavior",
    "InformedRRTStar",
    "JPSPlanner",
    "KinematicsFactory",
    "KinematicsHandler",
    "PRMPlanner",
    "RRTStar",
    "SocialForceModelBatch",
    "ackermann_kinematics",
    "contact_step",
    "differential_kinematics",
    "generate_polygon",
    "kinematics_factory",
    "omni_kinematics",
    "random_generate_polygon",
    "reciprocal_vel_obs",
    "register_behavior",
    "register_behavior_class",
    "register_group_behavior",
    "register_group_behavior_class",
    "register_kinematics",
    "social_force_model",
]


def __getattr__(name: str) -> Any:
    if name == "kinematics_factory":
        from irsim.lib.algorithm import kinematics

        value: Any = {
            "diff": kinematics.differential_kinematics,
            "acker": kinematics.ackermann_kinematics,
            "omni": kinematics.omni_kinematics,
        }
    else:
        value = _get(name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
