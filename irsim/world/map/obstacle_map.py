"""``ObstacleMap`` under the name of IR-SIM."""

from typing import Any

from irsim._names import from_homes

_get = from_homes(__name__, {"ObstacleMap": "irsim.map_view", "grid_collision_geometry": "irsim.world.cells"})


def __getattr__(name: str) -> Any:
    return _get(name)
