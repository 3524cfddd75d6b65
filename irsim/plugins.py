"""The door for authors of plug-ins: everything that a component outside irsim needs, from one module.

```python
from irsim.plugins import SENSORS, Meters, SensorOptions
```

An installed package offers its component through an entry point of the group ``irsim.<kind>``, such as
``irsim.sensors``. A policy, which does not belong to a scenario, has the group ``irsim.policies``. The names below stay
where they are when the rest of irsim is rearranged.
"""

from __future__ import annotations

from irsim.bridges.base import Bridge, BridgeError, BridgeLostError
from irsim.bridges.state import Feedback, Motion, WorldState
from irsim.components.kinematics._handler import KinematicsHandler, register_kinematics
from irsim.components.options import (
    BehaviorOptions,
    BridgeOptions,
    DistributionOptions,
    KinematicsOptions,
    MapOptions,
    PlannerOptions,
    SensorOptions,
    ShapeOptions,
)
from irsim.objects.extensions.registration import (
    register_behavior,
    register_behavior_class,
    register_group_behavior,
    register_group_behavior_class,
)
from irsim.options.base import Options
from irsim.options.registry import BEHAVIORS, BRIDGES, DISTRIBUTIONS, KINEMATICS, MAPS, PLANNERS, SENSORS, SHAPES
from irsim.options.units import (
    Bool,
    Count,
    Degrees,
    Fraction,
    Hertz,
    Integer,
    Kilograms,
    Meters,
    MetersPerSecond,
    MetersPerSecondSquared,
    Number,
    Pixels,
    Points,
    Radians,
    RadiansPerSecond,
    Seconds,
    unit,
)
from irsim.options.vectors import Point, Pose, vector
from irsim.policies import Episode, Map, Needs, Neighbors, Observations, Policy, Scan, register_policy
from irsim.simulation.scene import SceneDescription

__all__ = [
    "BEHAVIORS",
    "BRIDGES",
    "DISTRIBUTIONS",
    "KINEMATICS",
    "MAPS",
    "PLANNERS",
    "SENSORS",
    "SHAPES",
    "BehaviorOptions",
    "Bool",
    "Bridge",
    "BridgeError",
    "BridgeLostError",
    "BridgeOptions",
    "Count",
    "Degrees",
    "DistributionOptions",
    "Episode",
    "Feedback",
    "Fraction",
    "Hertz",
    "Integer",
    "Kilograms",
    "KinematicsHandler",
    "KinematicsOptions",
    "Map",
    "MapOptions",
    "Meters",
    "MetersPerSecond",
    "MetersPerSecondSquared",
    "Motion",
    "Needs",
    "Neighbors",
    "Number",
    "Observations",
    "Options",
    "Pixels",
    "PlannerOptions",
    "Point",
    "Points",
    "Policy",
    "Pose",
    "Radians",
    "RadiansPerSecond",
    "Scan",
    "SceneDescription",
    "Seconds",
    "SensorOptions",
    "ShapeOptions",
    "WorldState",
    "register_behavior",
    "register_behavior_class",
    "register_group_behavior",
    "register_group_behavior_class",
    "register_kinematics",
    "register_policy",
    "unit",
    "vector",
]
