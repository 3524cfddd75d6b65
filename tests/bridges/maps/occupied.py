"""Area that an imported file occupies, as a map and as obstacles."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import shapely

import irsim
from irsim.bridges.maps import import_map

__all__ = ["area_of_obstacles", "assert_occupied"]


def area_of_obstacles(scenario: Path) -> float:
    """Area of the union of the obstacles of a scenario [m²]."""
    env = irsim.make(str(scenario), display=False)
    return float(shapely.union_all([obstacle.geometry for obstacle in env.obstacle_list]).area)


def assert_occupied(file: Path, area: float, **options: Any) -> None:
    """A map of a file, and obstacles made of it, occupy an area to within 1 % [m²].

    Args:
        file: The file; the scenarios are written beside it.
        area: The area that it occupies, by its drawing.
        **options: Options of the import.
    """
    result = import_map(file, file.with_suffix(".map.yaml"), overwrite=True, **options)
    assert result.occupied * result.resolution**2 == pytest.approx(area, rel=0.01), "map"
    scenario = file.with_suffix(".obstacles.yaml")
    exact = import_map(file, scenario, obstacles=True, overwrite=True, **options)
    assert exact.obstacles > 0
    assert area_of_obstacles(scenario) == pytest.approx(area, rel=0.01), "obstacles"
