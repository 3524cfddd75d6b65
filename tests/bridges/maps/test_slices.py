"""Outlines of meshes between two heights, worked by hand: solids that overlap, touch, or look the wrong way."""

from __future__ import annotations

import numpy as np
import pytest

from irsim.bridges.maps.slices import slice_of_mesh, slice_of_prisms
from tests.bridges.maps.scenes import box


def area(*parts: np.ndarray, low: float = 0.2, high: float = 1.5) -> float:
    """Area of the outline of a mesh [m²]."""
    region = slice_of_mesh(np.concatenate(parts), low, high)
    return 0.0 if region is None else float(region.area)


def test_boxes_that_overlap_count_once() -> None:
    assert area(box([0, 0, 0], [1, 1, 2]), box([0.5, 0.5, 0], [1.5, 1.5, 2])) == pytest.approx(1.75)
    assert area(box([0, 0, 0], [9, 9, 2]), box([4, 4, 0], [6, 6, 2])) == pytest.approx(81)


def test_walls_around_a_room_leave_it_free() -> None:
    """Each wall is a box that ends within the next one, as walls of ``irsim export`` do."""
    sides = [([0, 0, 0], [10, 1, 2]), ([0, 9, 0], [10, 10, 2]), ([0, 0, 0], [1, 10, 2]), ([9, 0, 0], [10, 10, 2])]
    assert area(*(box(*side) for side in sides)) == pytest.approx(36)


def test_cells_of_a_map_that_touch_leave_holes_free() -> None:
    solid = np.random.default_rng(0).random((20, 20)) < 0.4
    cells = [box([0.1 * i, 0.1 * j, 0], [0.1 * i + 0.1, 0.1 * j + 0.1, 2]) for i, j in np.argwhere(solid)]
    assert area(*cells) == pytest.approx(0.01 * solid.sum(), rel=1e-6)


def test_the_inside_of_a_pipe_is_free() -> None:
    """Its inner surface looks inwards."""
    outer, inner = box([0, 0, -1], [4, 4, 3]), box([1, 1, -1], [3, 3, 3])[:, ::-1]
    assert area(outer, inner) == pytest.approx(16 - 4)


def test_surfaces_that_look_the_wrong_way_or_both_ways() -> None:
    whole = box([0, 0, 0], [3, 2, 2])
    mixed = whole.copy()
    mixed[::3] = mixed[::3, ::-1]
    assert [area(part) for part in (whole, whole[:, ::-1], mixed)] == pytest.approx([6, 6, 6])
    assert area(whole, whole[:, ::-1]) == pytest.approx(6)


def test_prisms_that_stand_upright() -> None:
    """Many boxes and a ring of one height, which is empty above itself; other solids are not prisms."""
    cells = np.concatenate([box([i, 0.3 * i, 0], [i + 1, 0.3 * i + 1, 2]) for i in range(40)])
    assert slice_of_prisms(cells, 0.2, 1.5)[1].area == pytest.approx(40)
    assert slice_of_prisms(cells, 2.1, 3) == (True, None)
    around = np.concatenate([cells, cells + np.array([0.5, 0, 0])])
    assert slice_of_prisms(around, 0.2, 1.5)[1].area == pytest.approx(slice_of_mesh(around, 0.2, 1.5).area)
    leaning, lower = cells + 0.01 * cells[..., 2:] * np.array([1, 0, 0]), box([0, 0, 0], [1, 1, 1])
    for part in (leaning, np.concatenate([cells, lower]), cells[:1], cells[:, ::-1][:5], np.zeros((2, 3, 3))):
        assert slice_of_prisms(part, 0.2, 1.5) == (False, None)
