"""Maps under the names of IR-SIM."""

from __future__ import annotations

from typing import Any

from irsim._names import from_homes

__all__ = [
    "EnvGridMap",
    "FogMap",
    "GridMapGenerator",
    "ImageGridGenerator",
    "Map",
    "ObstacleMap",
    "PerlinGridGenerator",
    "build_grid_from_generator",
    "grid_collision_geometry",
    "resolve_obstacle_map",
]

_get = from_homes(
    __name__,
    {
        "EnvGridMap": "irsim.navigation.map",
        "FogMap": "irsim.world.fog",
        "GridMapGenerator": "irsim.maps._generators",
        "ImageGridGenerator": "irsim.maps._generators",
        "Map": "irsim.navigation.map",
        "ObstacleMap": "irsim.map_view",
        "PerlinGridGenerator": "irsim.maps._generators",
        "build_grid_from_generator": "irsim.maps._generators",
        "grid_collision_geometry": "irsim.world.cells",
        "resolve_obstacle_map": "irsim.maps._generators",
    },
)


def __getattr__(name: str) -> Any:
    return _get(name)
