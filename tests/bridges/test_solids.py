"""Footprints and maps as boxes, disks and convex outlines, and as solids in stages of OpenUSD."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import irsim
from irsim.bridges.export.export import export_run
from irsim.bridges.export.registry import find_format
from irsim.bridges.solids import BoundingBox, Box, box_of, convex_pieces, is_convex, merged_cells, solids_of, triangles
from irsim.bridges.usd.files import export_scene
from irsim.bridges.usd.solids import Solid, arrow, disc_solid, grid_solid, line_solid, plane, polygon_solid, prim_names
from irsim.common.extras import ExtraError
from irsim.common.files import TargetError
from irsim.common.outline import Circle, Line, Polygon
from irsim.simulation.scene import Grid, SceneObject
from tests.effort import examples

U_SHAPE = np.array([[0, 0], [3, 0], [3, 3], [2, 3], [2, 1], [1, 1], [1, 3], [0, 3]], dtype=float)
PENTAGRAM = np.array([[math.cos(k * 0.8 * math.pi), math.sin(k * 0.8 * math.pi)] for k in range(5)])


def test_a_u_shape_stays_open() -> None:
    pieces = [shapely.Polygon(piece) for piece in convex_pieces(U_SHAPE)]
    assert len(pieces) == 3
    assert shapely.union_all(pieces).equals(shapely.Polygon(U_SHAPE))
    assert not any(piece.intersects(shapely.Point(1.5, 2)) for piece in pieces)


@settings(max_examples=examples(100), deadline=None)
@given(st.lists(st.floats(0.2, 1.0), min_size=3, max_size=24))
def test_pieces_are_convex_and_fill_the_polygon(radii: list[float]) -> None:
    angles = np.linspace(0, 2 * np.pi, len(radii), endpoint=False)
    corners = np.column_stack([np.cos(angles), np.sin(angles)]) * np.array(radii)[:, None]
    pieces = convex_pieces(corners)
    assert all(is_convex(piece) for piece in pieces)
    assert sum(shapely.Polygon(piece).area for piece in pieces) == pytest.approx(shapely.Polygon(corners).area)
    assert shapely.union_all([shapely.Polygon(piece) for piece in pieces]).area == pytest.approx(
        shapely.Polygon(corners).area
    )
    assert len(pieces) <= max(1, len(triangles(corners)))


def test_convex_is_told_from_concave() -> None:
    assert is_convex(np.array([[0, 0], [2, 0], [2, 1], [1, 1], [0, 1]], dtype=float))  # one corner is straight
    assert not is_convex(U_SHAPE)
    assert not is_convex(PENTAGRAM)  # turns left at each corner, but twice round


def test_rectangles_become_boxes_whatever_their_heading() -> None:
    turned = np.array([[0, 0], [2, 2], [1, 3], [-1, 1]], dtype=float)
    [box] = solids_of(Polygon(turned), 0.1)
    assert isinstance(box, Box)
    assert box.center == pytest.approx((0.5, 1.5))
    assert box.half == pytest.approx((math.sqrt(2), math.sqrt(0.5)))
    assert box.yaw == pytest.approx(math.pi / 4)
    [outline] = solids_of(Polygon(np.array([[0, 0], [2, 0], [2, 1], [0, 2]], dtype=float)), 0.1)
    assert isinstance(outline, Polygon)
    assert solids_of(Circle((1.0, 2.0), 0.5), 0.1) == [Circle((1.0, 2.0), 0.5)]


def test_polygons_without_area_or_that_cross_themselves_are_no_error() -> None:
    assert convex_pieces(np.array([[0, 0], [1, 0], [2, 0]], dtype=float)) == []
    assert convex_pieces(np.zeros((4, 2))) == []
    star = sum(shapely.Polygon(piece).area for piece in convex_pieces(PENTAGRAM))
    assert 0.5 < star < 3
    bow = np.array([[0, 0], [2, 2], [2, 0], [0, 2]], dtype=float)
    assert sum(shapely.Polygon(piece).area for piece in convex_pieces(bow)) > 0.9


def test_a_line_has_its_thickness_on_both_sides_and_a_room_outside() -> None:
    points = np.array([[0, 0], [4, 0], [4, 0], [4, 3]], dtype=float)
    boxes = solids_of(Line(points), 0.2)
    assert [box.center for box in boxes] == [(2.0, 0.0), (4.0, 1.5)]  # type: ignore[union-attr]
    assert boxes[0].half == (2.0, 0.1)  # type: ignore[union-attr]
    for corners in ([[0, 0], [4, 0], [4, 3], [0, 3]], [[0, 0], [0, 3], [4, 3], [4, 0]]):
        room = solids_of(Line(np.array(corners, dtype=float), closed=True), 0.2)
        solid = shapely.union_all([_area(box) for box in room])
        assert solid.area == pytest.approx(4.4 * 3.4 - 12)
        assert not solid.intersects(shapely.box(1e-6, 1e-6, 4 - 1e-6, 3 - 1e-6))


def test_a_large_hall_needs_few_boxes() -> None:
    occupied = np.zeros((1000, 800), dtype=bool)
    occupied[:10] = occupied[-10:] = True
    occupied[:, :10] = occupied[:, -10:] = True
    assert len(merged_cells(Grid(occupied, (0.05, 0.05), (0.0, 0.0)))) == 4


def _area(box: object) -> shapely.Polygon:
    assert isinstance(box, Box)
    square = shapely.box(-box.half[0], -box.half[1], box.half[0], box.half[1])
    cosine, sine = math.cos(box.yaw), math.sin(box.yaw)
    from shapely.affinity import affine_transform

    return affine_transform(square, [cosine, -sine, sine, cosine, *box.center])


def _agent(*parts: Any) -> SceneObject:
    return SceneObject(0, "a", "robot", None, True, (0, 0, 0), (), parts, 0.5, (), (), (), None, 1.0, (0, 0, 0))


@pytest.mark.parametrize(
    ("parts", "box"),
    [
        ((Circle((0.0, 0.0), 0.2),), BoundingBox(0, 0, 0.4, 0.4)),
        ((Polygon(np.array([[-1.0, -1], [3, -1], [3, 1], [-1, 1]])),), BoundingBox(1, 0, 4, 2)),
        ((Circle((0.0, 1.0), 0.5), Circle((2.0, 0.0), 0.5)), BoundingBox(1, 0.5, 3, 2)),
        ((Line(np.array([[0.0, 0], [4, 0]])),), BoundingBox(2, 0, 4, 0.01)),
        ((), BoundingBox(0, 0, 1, 1)),
    ],
)
def test_box(parts: Any, box: BoundingBox) -> None:
    assert vars(box_of(_agent(*parts))) == pytest.approx(vars(box))


def faces(solid: Solid) -> list[list[int]]:
    ends = np.cumsum(solid.counts)
    return [solid.indices[end - count : end].tolist() for end, count in zip(ends, solid.counts, strict=True)]


def check_closed(solid: Solid) -> None:
    """Each edge belongs to two faces that run through it in opposite directions."""
    edges = Counter((face[k], face[(k + 1) % len(face)]) for face in faces(solid) for k in range(len(face)))
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)


def volume(solid: Solid) -> float:
    """Signed volume, positive if the faces run counterclockwise seen from outside."""
    total = 0.0
    for face in faces(solid):
        a, *rest = solid.points[face]
        total += sum(np.dot(a, np.cross(b, c)) for b, c in itertools.pairwise(rest)) / 6
    return float(total)


def test_a_convex_polygon() -> None:
    solid = polygon_solid(Polygon(np.array([[0, 0], [2, 0], [2, 1.0], [0, 1]])), 3.0)
    check_closed(solid)
    assert solid.convex
    assert volume(solid) == pytest.approx(6.0)
    np.testing.assert_allclose(solid.normals[:4], [[0, 0, -1]] * 4)
    np.testing.assert_allclose(solid.normals[4:8], [[0, 0, 1]] * 4)
    middle = solid.points.mean(axis=0)
    outwards = (solid.points[solid.indices] - middle) * solid.normals
    assert (outwards.sum(axis=1) > 0).all()


@pytest.mark.parametrize("turn", [1, -1])
def test_a_concave_polygon_whichever_way_it_runs(turn: int) -> None:
    solid = polygon_solid(Polygon(U_SHAPE[::turn]), 2.0)
    check_closed(solid)
    assert not solid.convex
    assert volume(solid) == pytest.approx(2 * (9 - 2))
    np.testing.assert_allclose(np.linalg.norm(solid.normals, axis=1), 1)


@settings(max_examples=examples(50))
@given(radii=st.lists(st.floats(0.1, 5), min_size=3, max_size=12), height=st.floats(0.1, 4))
def test_any_star_shape(radii: list[float], height: float) -> None:
    angle = np.linspace(0, 2 * np.pi, len(radii), endpoint=False)
    corners = np.array(radii)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    solid = polygon_solid(Polygon(corners), height)
    x, y = corners.T
    area = (x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    check_closed(solid)
    assert volume(solid) == pytest.approx(area * height, rel=1e-9)


def test_a_crossed_outline_is_two_bodies_and_a_flat_one_is_none() -> None:
    bow = polygon_solid(Polygon(np.array([[0, 0], [2, 2], [2, 0], [0, 2.0]])), 1.0)
    assert volume(bow) == pytest.approx(2.0)
    assert polygon_solid(Polygon(np.array([[0, 0], [1, 0], [2, 0.0]])), 1.0) is None


def test_walls_have_boxes_that_meet() -> None:
    room = line_solid(Line(np.array([[0, 0], [4, 0], [4, 3], [0, 3.0]]), closed=True), 1.0, 0.1)
    check_closed(room)
    assert len(room.counts) == 4 * 6
    np.testing.assert_allclose([room.points.min(axis=0), room.points.max(axis=0)], [[-0.05, -0.05, 0], [4.05, 3.05, 1]])
    single = line_solid(Line(np.array([[0, 0], [1, 0], [1, 0.0]])), 1.0)
    assert single.convex
    assert line_solid(Line(np.array([[1, 1], [1, 1.0]])), 1.0) is None


@settings(max_examples=examples(50))
@given(data=st.data(), columns=st.integers(1, 7), rows=st.integers(1, 7))
def test_boxes_of_a_map_cover_its_cells_once(data, columns: int, rows: int) -> None:
    cells = np.array(data.draw(st.lists(st.booleans(), min_size=columns * rows, max_size=columns * rows)))
    occupied = cells.reshape(columns, rows)
    solid = grid_solid(Grid(occupied, (0.5, 0.25), (1.0, -2.0)), 2.0)
    if not occupied.any():
        assert solid is None
        return
    check_closed(solid)
    assert volume(solid) == pytest.approx(occupied.sum() * 0.5 * 0.25 * 2.0)
    covered = np.zeros_like(occupied, dtype=int)
    for box in solid.points.reshape(-1, 8, 3):
        x0, y0 = np.round((box.min(axis=0)[:2] - [1.0, -2.0]) / [0.5, 0.25]).astype(int)
        x1, y1 = np.round((box.max(axis=0)[:2] - [1.0, -2.0]) / [0.5, 0.25]).astype(int)
        covered[x0:x1, y0:y1] += 1
    np.testing.assert_array_equal(covered, occupied)


def test_discs() -> None:
    solid = disc_solid(Circle((1.0, -2.0), 0.5), 2.0)
    check_closed(solid)
    assert volume(solid) == pytest.approx(np.pi * 0.25 * 2, rel=5e-3)
    np.testing.assert_allclose([solid.points.min(axis=0), solid.points.max(axis=0)], [[0.5, -2.5, 0], [1.5, -1.5, 2]])


def test_ground_looks_up_and_the_arrow_forwards() -> None:
    np.testing.assert_allclose(plane((0, 0), (2, 1)).normals, [[0, 0, 1]] * 4)
    wedge = arrow(0.5, 1.0, 1.1)
    check_closed(wedge)
    assert wedge.points[:, 0].argmax() in (0, 3)
    np.testing.assert_allclose([wedge.points[:, 2].min(), wedge.points[:, 2].max()], [1.0, 1.1])


def test_names_of_prims() -> None:
    names = ["robot 1", "robot_1", "Robot_1", "7up", "", "héllo/ß", "x" * 500]
    result = prim_names(names)
    assert result[:5] == ["robot_1", "robot_1_2", "Robot_1_3", "_7up", "object"]
    assert len({name.lower() for name in result}) == len(names)
    assert all(name.isascii() and name.isidentifier() for name in result)


TEXT = """
world: {width: 5, height: 5, time_limit: 0.5}
robot:
  - {state: [1, 1, 0], goal: [4, 4], kinematics: {name: diff}, behavior: {name: dash},
     shape: {name: circle, radius: 0.2}}
"""


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "scene.yaml").write_text(TEXT)
    irsim.run(str(tmp_path / "scene.yaml"), record=tmp_path / "run")
    monkeypatch.setattr("irsim.common.extras.find_spec", lambda module: None)
    return tmp_path


@pytest.mark.parametrize(("name", "extra"), [("x.usda", "usd"), ("x.usdz", "usd"), ("x.xml", "scenarios")])
def test_a_run(scene: Path, name: str, extra: str) -> None:
    to = "commonroad" if name.endswith("xml") else None
    with pytest.raises(ExtraError, match=rf"pip install 'irsim-mcp\[{extra}\]'"):
        export_run(scene / "run", scene / name, to=to)
    assert not (scene / name).exists()


def test_a_scenario(scene: Path) -> None:
    with pytest.raises(ExtraError, match=r"irsim-mcp\[usd\]"):
        export_scene(scene / "scene.yaml", scene / "x.usda")


def test_suffixes(scene: Path) -> None:
    for suffix in (".usda", ".usdc", ".usdz", ".USDA"):
        assert find_format(None, Path(f"run{suffix}")).name == "usd"
    with pytest.raises((TargetError, ExtraError)):
        export_run(scene / "run", scene / "x.glb", to="usd")
