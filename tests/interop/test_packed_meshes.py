"""Meshes as other programs pack them: the map is the same as from the plain file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irsim.bridges.maps import import_map
from tests.bridges.maps.scenes import box, write_glb

pytestmark = pytest.mark.interop
pytest.importorskip("trimesh")


@pytest.mark.foreign
def test_a_packed_room_has_the_map_of_the_plain_one(foreign, tmp_path) -> None:
    pictures = {}
    for name in ("simple_room", "room_quant", "room_draco", "room_meshopt"):
        result = import_map(foreign / "gltf" / f"{name}.glb", tmp_path / f"{name}.yaml")
        assert (result.columns, result.rows, result.occupied) == (213, 219, 3382)
        assert result.free_area == pytest.approx(108.16, abs=0.005)
        pictures[name] = Path(result.files[1]).read_bytes()
    assert len(set(pictures.values())) == 1


@pytest.mark.foreign
def test_a_mesh_with_its_own_packing(foreign, tmp_path) -> None:
    result = import_map(foreign / "gltf" / "nav_test_draco.glb", tmp_path / "a.yaml")
    assert result.free_area == pytest.approx(81.5, abs=0.5)


def test_a_mesh_that_lies_on_its_side_is_stood_up(tmp_path) -> None:
    floor = np.concatenate([box([0, 0, -0.1], [8, 6, 0]), box([1, 1, 0], [2, 2, 1])])
    upright = import_map(write_glb(tmp_path / "y.glb", floor), tmp_path / "y.yaml")
    lying = np.stack([floor[..., 0], -floor[..., 2], floor[..., 1]], axis=-1)  # which the writer turns back
    result = import_map(write_glb(tmp_path / "z.glb", lying), tmp_path / "z.yaml")
    assert result.free_area == pytest.approx(upright.free_area, abs=0.5)
    assert any("taken to point up" in note for note in result.notes)
