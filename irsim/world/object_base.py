"""Objects under the names of IR-SIM."""

from typing import Any

from irsim._names import from_homes

_get = from_homes(
    __name__,
    {
        "ObjectBase": "irsim.object_base",
        "ObjectInfo": "irsim.info",
        "ObstacleInfo": "irsim.info",
    },
)


def __getattr__(name: str) -> Any:
    return _get(name)
