"""Footprints and maps as boxes, disks and convex outlines."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim.bridges.solids import BoundingBox, Box, box_of, convex_pieces, is_convex, merged_cells, solids_of, triangles
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


@settings(max_examples=examples(60), deadline=None)
@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 2**32 - 1), st.floats(0, 1))
def test_merged_cells_cover_exactly_what_is_solid(nx: int, ny: int, seed: int, share: float) -> None:
    occupied = np.random.default_rng(seed).random((nx, ny)) < share
    boxes = merged_cells(Grid(occupied, (0.5, 0.25), (-1.0, 2.0)))
    covered = np.zeros((nx, ny), dtype=int)
    for x0, y0, x1, y1 in boxes:
        columns = slice(round((x0 + 1) / 0.5), round((x1 + 1) / 0.5))
        rows = slice(round((y0 - 2) / 0.25), round((y1 - 2) / 0.25))
        covered[columns, rows] += 1
    assert (covered == occupied).all()


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
