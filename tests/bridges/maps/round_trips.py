"""A scene of which every shape goes to another program as a file and comes back as a map."""

from __future__ import annotations

from typing import Any

import shapely
import shapely.affinity

from irsim.bridges.export.export import export_run
from irsim.bridges.maps import import_map
from irsim.bridges.recorded import recorded_scene
from irsim.bridges.solids import Box, merged_cells, room_of, solids_of
from irsim.common.outline import Circle, Line
from tests.bridges.scenes import recorded

__all__ = ["LARGE_MAP", "MAP", "SHAPES", "WALLS", "differing_share"]

_ROBOT = """
robot:
  - {name: r, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0], goal: [2, 1]}
"""
SHAPES = f"""
world: {{width: 12, height: 8}}
{_ROBOT}
obstacle:
  - {{name: crate, state: [3, 3, 0.4], shape: {{name: rectangle, length: 2, width: 0.8}}}}
  - {{name: disc, state: [6, 3, 0], shape: {{name: circle, radius: 0.7, center: [0.2, 0]}}}}
  - {{name: roof, state: [8, 2, 0.3], shape: {{name: polygon, vertices: [[0, 0], [1.5, 0], [0.7, 1.1]]}}}}
  - {{name: angle, state: [4, 5.5, 0.2], shape: {{name: polygon, vertices: [[0, 0], [1.5, 0], [1.5, 1.5], [1, 1.5],
     [1, 0.5], [0, 0.5]]}}}}
"""
WALLS = f"""
world: {{width: 6, height: 4, boundary: walls}}
{_ROBOT}
obstacle:
  - {{name: fence, shape: {{name: linestring, vertices: [[2.5, 1], [4, 1], [4.8, 2.2]]}}}}
"""
MAP = f"""
world: {{width: 8, height: 6, obstacle_map: {{name: perlin, resolution: 0.25, seed: 3, fill: 0.2}}}}
{_ROBOT}
"""
LARGE_MAP = f"""
world: {{width: 60, height: 60, obstacle_map: {{name: perlin, resolution: 0.2, seed: 3, fill: 0.3, complexity: 0.6}}}}
{_ROBOT}
"""
"""Its walls have several times as many triangles as a mesh may have that is cut one by one."""


def differing_share(
    text: str,
    file: str,
    *,
    to: str,
    thick: float,
    wall: float,
    **options: Any,
) -> float:
    """Share by which the occupied area of an imported scene differs from the area of the scene.

    Args:
        text: The scenario.
        file: The file that the export writes.
        to: Its format.
        thick: Thickness that lines get in it [m].
        wall: Thickness of the walls of the world and of rooms in it [m].
        **options: Options of the import.
    """
    run = recorded(text, 1)
    export_run(run, file.partition("/")[0], to=to, objects="all")
    result = import_map(file, "back.yaml", **options)
    expected = _area(run, thick, wall)
    return abs(result.occupied * result.resolution**2 - expected) / expected


def _area(run: Any, thick: float, wall: float) -> float:
    """Area of all that stands still in a scene [m²]."""
    scene = recorded_scene(run)
    regions = [shapely.box(*cell) for cell in merged_cells(scene.grid)] if scene.grid is not None else []
    room = room_of(scene)
    if room is not None:
        regions += [_region(solid, (0.0, 0.0, 0.0)) for solid in solids_of(room, wall)]
    for agent in scene.agents:
        if agent.role != "robot":
            for part in agent.parts:
                closed = isinstance(part, Line) and part.closed
                regions += [_region(solid, agent.pose) for solid in solids_of(part, wall if closed else thick)]
    return float(shapely.union_all(regions).area)


def _region(solid: Any, pose: tuple[float, float, float]) -> Any:
    """The area of a solid of a body at a pose."""
    if isinstance(solid, Circle):
        region = shapely.Point(solid.center).buffer(solid.radius, quad_segs=64)
    elif isinstance(solid, Box):
        (x, y), (a, b) = solid.center, solid.half
        region = shapely.affinity.rotate(shapely.box(x - a, y - b, x + a, y + b), solid.yaw, use_radians=True)
    else:
        region = shapely.Polygon(solid.corners)
    region = shapely.affinity.rotate(region, pose[2], origin=(0, 0), use_radians=True)
    return shapely.affinity.translate(region, pose[0], pose[1])
