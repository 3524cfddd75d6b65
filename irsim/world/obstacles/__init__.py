"""Classes of obstacles that IR-SIM has deprecated."""

from typing import Any

from irsim._names import from_homes

_get = from_homes(
    __name__,
    {
        "ObjectStatic": "irsim.object_base",
        "ObstacleAcker": "irsim.object_base",
        "ObstacleDiff": "irsim.object_base",
        "ObstacleOmni": "irsim.object_base",
    },
)


def __getattr__(name: str) -> Any:
    return _get(name)
