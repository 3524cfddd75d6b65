"""The outline of a body in all its forms, against closed forms and shapely."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import irsim
from irsim.common.outline import Cells, Circle, Line, Outline, Polygon, outline, part_of, triangles_of
from irsim.simulation.simulation import Simulation

SCENE = """
world: {width: 10, height: 10, boundary: walls, obstacle_map: MAP}
robot:
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.5, center: [0.2, 0]}, state: [2, 3, 1.5707963267948966]}
obstacle:
  - {shape: {name: rectangle, length: 2, width: 1}, state: [6, 3, 0.5]}
  - {shape: {name: linestring, vertices: [[0, 0], [1, 0], [1, 1]]}, state: [6, 6, 0]}
  - shape:
      name: compound
      parts: [{name: circle, radius: 0.3}, {name: rectangle, length: 1, width: 0.2, pose: [0.5, 0, 0]}]
    state: [2, 7, 0]
"""


@pytest.fixture
def simulation(tmp_path: Path) -> Simulation:
    from PIL import Image

    picture = np.full((10, 10), 255, dtype=np.uint8)
    picture[4:6, 4:6] = 0
    Image.fromarray(picture).save(tmp_path / "map.png")
    text = SCENE.replace("MAP", str(tmp_path / "map.png"))
    (tmp_path / "scene.yaml").write_text(text, encoding="utf-8")
    return irsim.make(str(tmp_path / "scene.yaml"), headless=True).simulation


def row_of(simulation: Simulation, shape: str) -> int:
    return next(i for i, record in enumerate(simulation.scenario.objects) if record.shape.name == shape)


def test_a_circle_turns_with_its_body(simulation: Simulation) -> None:
    row = row_of(simulation, "circle")
    (own,), (placed,) = outline(simulation.state, row).parts, outline(simulation.state, row, world_frame=True).parts
    assert own == Circle((0.2, 0.0), 0.5)
    assert isinstance(placed, Circle)
    assert placed.center == pytest.approx((2, 3.2))


def test_each_kind_of_part_is_told_from_the_others(simulation: Simulation) -> None:
    kinds = {name: [type(part) for part in outline(simulation.state, row_of(simulation, name)).parts]
             for name in ("rectangle", "linestring", "compound", "map", "walls")}  # fmt: skip
    assert kinds == {
        "rectangle": [Polygon],
        "linestring": [Line],
        "compound": [Circle, Polygon],
        "map": [Cells],
        "walls": [Line],
    }
    (walls,) = outline(simulation.state, row_of(simulation, "walls")).parts
    assert isinstance(walls, Line)
    assert walls.closed


def test_the_box_encloses_all_parts(simulation: Simulation) -> None:
    low, high = outline(simulation.state, row_of(simulation, "compound")).box()
    assert low.tolist() == pytest.approx([-0.3, -0.3])
    assert high.tolist() == pytest.approx([1.0, 0.3])
    assert np.isinf(Outline(()).box()).all()


@pytest.mark.parametrize("shape", ["circle", "rectangle", "linestring", "compound", "map", "walls"])
def test_shapely_core_and_box_agree(simulation: Simulation, shape: str) -> None:
    import irsim._core as core

    body = outline(simulation.state, row_of(simulation, shape), world_frame=True)
    low, high = body.box()
    geometry = body.shapely()
    if shape == "map":  # its box is the picture's, its geometry the outline of the occupied cells
        assert geometry.bounds == pytest.approx((4, 4, 6, 6))
    else:
        assert geometry.bounds == pytest.approx((*low, *high), abs=1e-12)
    x, y = geometry.representative_point().coords[0]
    still = [0.0, 0.0, 0.0]
    assert core.intersects(body.core(), still, [core.Circle(radius=1e-6, center=(x, y))], still)
    assert not core.intersects(body.core(), still, [core.Circle(radius=0.01, center=(-5, -5))], still)


def test_the_core_gives_back_the_parts(simulation: Simulation) -> None:
    for shape in ("circle", "rectangle", "linestring", "compound", "walls"):
        body = outline(simulation.state, row_of(simulation, shape))
        again = Outline([part for part in map(part_of, body.core()) if part is not None])
        assert again.shapely(8).equals(body.shapely(8))
        assert [type(part) for part in again.parts] == [type(part) for part in body.parts]
    assert part_of(outline(simulation.state, row_of(simulation, "map")).core()[0]) is None


def test_triangles_fill_areas_with_holes_and_leave_out_lines() -> None:
    import shapely

    ring = shapely.box(0, 0, 4, 4).difference(shapely.box(1, 1, 2, 2))
    triangles = triangles_of(
        shapely.GeometryCollection([ring, shapely.box(9, 0, 8, 2), shapely.LineString([(0, 0), (1, 1)])])
    )
    first, second = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    areas = (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / 2
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(17.0)
    assert triangles_of(shapely.Point(0, 0)).shape == (0, 3, 2)


def test_the_hull_encloses_circles_and_runs_counterclockwise(simulation: Simulation) -> None:
    import shapely

    corners = outline(simulation.state, row_of(simulation, "compound")).hull()
    x, y = corners.T
    assert x @ np.roll(y, -1) - y @ np.roll(x, -1) > 0
    exact = shapely.union_all([shapely.Point(0, 0).buffer(0.3, quad_segs=64), shapely.box(0, -0.1, 1, 0.1)])
    assert shapely.Polygon(corners).buffer(1e-9).contains(exact)
    assert len(outline(simulation.state, row_of(simulation, "circle")).hull()) == 16
    assert np.abs(corners).max() <= max(1.0, 0.3 / math.cos(math.pi / 16)) + 1e-12
