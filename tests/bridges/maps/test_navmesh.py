"""Navigation meshes: what is read, and that damaged files are refused wherever they are damaged."""

from __future__ import annotations

import struct
import tracemalloc
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim import api
from irsim.bridges.base import BridgeError
from irsim.bridges.maps import import_map, read_sidecar
from irsim.bridges.maps.kinds.navmesh import read_tiles
from tests.bridges.maps.navmesh_files import TWO_ROOMS, UPSTAIRS, mesh_set, tile


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
    good = mesh_set(tile(TWO_ROOMS))
    nan = struct.pack("<f", float("nan"))
    for content, said in [
        (b"MSET" + good[4:], "TESM"),
        (good[:4] + struct.pack("<i", 3) + good[8:], "version 3"),
        (good[:8] + struct.pack("<i", -1) + good[12:], "-1 tiles"),
        (good[:8] + struct.pack("<i", 2**31 - 1) + good[12:], "tiles"),
        (good[:44] + struct.pack("<I", 2**32 - 1) + good[48:], "tile 0 of"),
        (good[:48] + b"DNAV" + good[52:], "Detour's version"),
        (good[:148] + nan + good[152:], "no numbers"),
        (good[:108] + nan + good[112:], "agent"),
        (mesh_set(version=2) + b"", None),
        (mesh_set(tile(TWO_ROOMS), version=2, settings=4000), "no tile begins"),
    ]:
        if said is None:
            assert read_tiles(Path("x.navmesh"), content) == []
            continue
        with pytest.raises(BridgeError, match=said):
            read_tiles(Path("x.navmesh"), content)


def test_a_set_without_polygons(tmp_path) -> None:
    for content in (mesh_set(), mesh_set(tile(()))):
        with pytest.raises(BridgeError, match="no polygons"):
            import_map(write(tmp_path, content), tmp_path / "scene.yaml")
