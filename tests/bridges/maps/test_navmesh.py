"""Navigation meshes, and the grid that scenes are laid on."""

from __future__ import annotations

import struct
import tracemalloc
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim import api
from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map, read_sidecar
from irsim.bridges.maps.grid import SIDES, Grid, grid_over, rows_of
from irsim.bridges.maps.kinds.navmesh import read_tiles
from irsim.bridges.maps.voxels import floors_of, spans_of, walkable_of
from tests.bridges.maps.scenes import TWO_ROOMS, UPSTAIRS, mesh_set, tile


def write(folder: Path, content: bytes) -> Path:
    file = folder / "scene.navmesh"
    file.write_bytes(content)
    return file


@pytest.mark.parametrize(("version", "size"), [(1, 0), (2, 80), (2, 96), (2, 0)])
def test_a_map_of_it(tmp_path, version, size) -> None:
    content = mesh_set(tile(TWO_ROOMS, height=1.8), tile(UPSTAIRS), version=version, settings=size)
    result = import_map(write(tmp_path, content), tmp_path / "scene.yaml")
    assert result.free_area == pytest.approx(4 * 3 + 0.5 * 1 + 2.5 * 3, rel=0.01)
    assert [(round(one.height, 2), one.roof) for one in result.levels] == [(0.1, False), (3.0, True)]
    assert "0.10 m" in result.notes[0]
    sidecar = read_sidecar(tmp_path / "scene.yaml")
    assert sidecar.to_scene([[1.0, 2.0]]) == pytest.approx(np.array([[1.0, 0.1, -2.0]]))
    assert sidecar.agent["radius"] == pytest.approx(0.1)
    assert sidecar.agent["headroom"] == pytest.approx(1.8)
    scenario, _ = api.read_scenario(tmp_path / "scene.yaml", strict=True)
    free = scenario.grid.cells.occupied == 0
    assert free.sum() * 0.05**2 == pytest.approx(result.free_area)


def test_levels_are_picked(tmp_path) -> None:
    file = write(tmp_path, mesh_set(tile(TWO_ROOMS), tile(UPSTAIRS)))
    up = import_map(file, tmp_path / "up.yaml", level=1)
    assert (up.height, up.free_area) == (3.0, pytest.approx(9, rel=0.02))
    assert import_map(file, tmp_path / "high.yaml", height=2.7).level == 1


@pytest.mark.parametrize("version", [1, 2])
def test_a_file_that_ends_anywhere_is_refused(tmp_path, version) -> None:
    content = mesh_set(tile(TWO_ROOMS), tile(UPSTAIRS), version=version)
    assert len(read_tiles(Path("x.navmesh"), content)) == 2
    for length in range(len(content)):
        with pytest.raises(BridgeError) as caught:
            read_tiles(Path("x.navmesh"), content[:length])
        assert caught.value.code == "bridge-file"
    file = write(tmp_path, content[: len(content) // 2])
    with pytest.raises(BridgeError, match="tile"):
        import_map(file, tmp_path / "scene.yaml")
    assert [path.name for path in tmp_path.iterdir()] == ["scene.navmesh"]


@given(data=st.data())
@settings(max_examples=150)
def test_changed_bytes_give_a_map_or_a_clear_error(data) -> None:
    content = bytearray(mesh_set(tile(TWO_ROOMS), tile(UPSTAIRS), version=2))
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    with suppress(BridgeError):
        tiles = read_tiles(Path("x.navmesh"), bytes(content))
        assert all(np.isfinite(one.triangles).all() for one in tiles)


@pytest.mark.parametrize("key", ["polygons", "verts", "links", "details", "extra", "triangles"])
@pytest.mark.parametrize("count", [-1, 1 << 20, 2**31 - 1])
def test_counts_that_the_file_cannot_have(key, count) -> None:
    content = mesh_set(tile(TWO_ROOMS, change={key: count}))
    tracemalloc.start()
    with pytest.raises(BridgeError, match="promises more than its"):
        read_tiles(Path("x.navmesh"), content)
    assert tracemalloc.get_traced_memory()[1] < 1 << 20
    tracemalloc.stop()


def test_other_wrong_contents() -> None:
    assert read_tiles(Path("x.navmesh"), mesh_set(version=2)) == []
    good = mesh_set(tile(TWO_ROOMS))
    nan = struct.pack("<f", float("nan"))
    for content, said in [
        (b"MSET" + good[4:], "TESM"),
        (good[:4] + struct.pack("<i", 3) + good[8:], "version 3"),
        (good[:8] + struct.pack("<i", -1) + good[12:], "-1 tiles"),
        (good[:8] + struct.pack("<i", 2**31 - 1) + good[12:], "tiles"),
        (good[:44] + struct.pack("<I", 2**32 - 1) + good[48:], "tile 0 of"),
        (good[:48] + b"DNAV" + good[52:], "Detour's version"),
        (good[:148] + nan + good[152:], "not numbers"),
        (good[:108] + nan + good[112:], "agent"),
        (mesh_set(tile(TWO_ROOMS), version=2, settings=4000), "no tile begins"),
    ]:
        with pytest.raises(BridgeError, match=said):
            read_tiles(Path("x.navmesh"), content)


def test_a_set_without_polygons(tmp_path) -> None:
    for content in (mesh_set(), mesh_set(tile(()))):
        with pytest.raises(BridgeError, match="no polygons"):
            import_map(write(tmp_path, content), tmp_path / "scene.yaml")


NUMBER = st.integers(-40, 140).map(lambda n: n / 17)
CORNERS = st.tuples(*[st.tuples(NUMBER, NUMBER, NUMBER)] * 3)


def cells(corners, at_centers: bool) -> set[tuple[int, int]]:
    parts = [np.column_stack([i, j]) for _, i, j, _ in rows_of(np.array([corners], float), at_centers=at_centers)]
    return {tuple(cell) for cell in np.concatenate([np.zeros((0, 2), int), *parts]).tolist()}


@given(corners=CORNERS)
@settings(max_examples=150)
def test_every_touched_cell_is_found(corners) -> None:
    flat = np.array(corners)[:, :2]
    shape = shapely.MultiPoint(flat).convex_hull
    i, j = (x.ravel() for x in np.meshgrid(np.arange(-5, 12), np.arange(-5, 12)))
    boxes = shapely.box(i, j, i + 1, j + 1)
    touched = cells(flat, at_centers=False)
    shared, near = shapely.area(shapely.intersection(boxes, shape)) > 1e-9, shapely.dwithin(boxes, shape, 1e-9)
    inside, touching = ({*zip(i[of].tolist(), j[of].tolist(), strict=True)} for of in (shared, near))
    assert inside <= touched <= touching


@given(corners=CORNERS)
@settings(max_examples=60, deadline=None)
def test_heights_are_those_of_the_part_within_the_cell(corners) -> None:
    grid = Grid(-5.0, -5.0, 1.0, 20, 20)
    triangle = np.array([corners])
    spans = spans_of(triangle, grid, 0.7, 0.0)
    t = np.stack(np.meshgrid(*[np.linspace(0, 1, 90)] * 2), -1).reshape(-1, 2)
    t = t[t.sum(axis=1) <= 1]
    points = triangle[0, 0] + t @ (triangle[0, 1:] - triangle[0, 0])
    points = points[(np.abs(points[:, :2] - np.round(points[:, :2])) > 1e-6).all(axis=1)]  # not on lines of the grid
    column = ((np.floor(points[:, 0]) + 5) * 20 + np.floor(points[:, 1]) + 5).astype(int)
    for one in np.unique(column):
        own = points[column == one, 2]
        low, high = spans.low[spans.column == one], spans.high[spans.column == one]
        assert len(low) == 1
        assert low[0] <= own.min() + 0.006
        assert high[0] >= own.max() - 0.006
        rise = np.ptp(triangle[0], axis=0)
        if (column == one).sum() > 2000:  # sampled densely enough to know the ends
            assert low[0] >= own.min() - 0.05 * rise.max() - 0.01
            assert high[0] <= own.max() + 0.05 * rise.max() + 0.01


def test_triangles_with_a_common_edge_share_no_center() -> None:
    rng = np.random.default_rng(5)
    points = np.column_stack([rng.uniform(0, 9, (40, 2)), np.zeros(40)])
    triangulation = shapely.delaunay_triangles(shapely.MultiPoint(points[:, :2]))
    triangles = np.array([list(part.exterior.coords)[:3] for part in triangulation.geoms])
    seen = [tuple(cell) for _, i, j, _ in rows_of(triangles * 7, at_centers=True) for cell in zip(i, j, strict=True)]
    assert len(seen) == len(set(seen))
    area = shapely.convex_hull(shapely.MultiPoint(points[:, :2])).area
    assert len(seen) / 49 == pytest.approx(area, rel=0.02)


def test_floors_have_the_heights_of_their_planes() -> None:
    ramp = np.array([[[0, 0, 0], [4, 0, 2], [4, 2, 2]], [[0, 0, 0], [4, 2, 2], [0, 2, 0]]], float)
    grid = Grid(-1.0, -1.0, 0.5, 14, 8)
    floors = floors_of(ramp, grid, 1.0)
    assert len(floors.column) == 8 * 4
    assert floors.floor == pytest.approx(grid.centers(floors.column)[:, 0] / 2)


def test_a_wall_over_a_door_leaves_the_door_open() -> None:
    """A long triangle of a wall reaches from the floor beside the door to the lintel above it."""
    corners = [[[0, 0], [0, 2.5], [5, 2.5]], [[5, 2.1], [0, 0], [5, 2.5]]]
    wall = np.insert(np.array(corners, float), 0, 0.52, axis=-1)
    ground = np.array([[[0, 0, 0], [1, 0, 0], [1, 5, 0]], [[0, 0, 0], [1, 5, 0], [0, 5, 0]]], float)
    grid = Grid(-0.1, -0.1, 0.1, 13, 53)
    spans = spans_of(np.concatenate([wall, ground]), grid, 0.7, 0.2)
    x, y = grid.centers(walkable_of(spans, 1.5, 0.2).column).T
    y = y[np.isclose(x, 0.55)]
    below = 2.1 / 5 * y  # the lower edge of the wall
    assert (below[y > 0] >= 1.45).all()
    assert y.max() > 4.9


@pytest.mark.parametrize("size", [(5000.0, 4000.0), (1e6, 0.1)])
def test_too_many_cells_name_the_resolution_that_fits(size) -> None:
    with pytest.raises(BridgeError, match="--resolution") as caught:
        grid_over(np.zeros(2), np.array(size), 0.05, 1_000_000)
    advised = float(str(caught.value.fix).split()[-1])
    assert advised in SIDES
    grid = grid_over(np.zeros(2), np.array(size), advised, 1_000_000)
    assert 30_000 < grid.columns <= 1_000_000
    with pytest.raises(BridgeError, match="--resolution"):
        grid_over(np.zeros(2), np.array(size), max(side for side in SIDES if side < advised), 1_000_000)


def test_a_scene_for_which_no_cell_is_large_enough() -> None:
    with pytest.raises(BridgeError, match="give a smaller scene") as caught:  # which meters_per_unit gives, too
        grid_over(np.zeros(2), np.array([1e9, 1e9]), 0.05, 1_000_000, ", or its unit")
    assert str(caught.value.fix).endswith("or its unit")
    with pytest.raises(BridgeError, match="more than 16 cells"):  # the least grid has more cells than this bound
        grid_over(np.zeros(2), np.array([5000.0, 4000.0]), 0.05, 4)


def test_no_triangle_no_span() -> None:
    assert not len(walkable_of(spans_of(np.zeros((1, 3, 3)), Grid(-1, -1, 1.0, 3, 3), 0.7, 0.1), 1.0, 0.1).column)
