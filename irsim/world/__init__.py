"""World and objects: building the arrays of the core; names of IR-SIM, imported when first used."""

from typing import Any

from irsim._names import from_homes

__all__ = [
    "ObjectBase",
    "ObjectFactory",
    "ObjectGroup",
    "ObjectStatic",
    "ObstacleAcker",
    "ObstacleDiff",
    "ObstacleMap",
    "ObstacleOmni",
    "RobotAcker",
    "RobotDiff",
    "RobotOmni",
    "SensorFactory",
    "World",
]

_get = from_homes(
    __name__,
    {
        "ObjectBase": "irsim.object_base",
        "ObjectFactory": "irsim.object_factory",
        "ObjectGroup": "irsim.object_base",
        "ObjectStatic": "irsim.object_base",
        "ObstacleAcker": "irsim.object_base",
        "ObstacleDiff": "irsim.object_base",
        "ObstacleMap": "irsim.world.map",
        "ObstacleOmni": "irsim.object_base",
        "RobotAcker": "irsim.object_base",
        "RobotDiff": "irsim.object_base",
        "RobotOmni": "irsim.object_base",
        "SensorFactory": "irsim.sensor_factory",
        "World": "irsim.object_base",
    },
)


def __getattr__(name: str) -> Any:
    return _get(name)
