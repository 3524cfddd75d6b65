"""Triangles of descriptions of glTF: strips, fans, sparse and quantized values, instances, hidden nodes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.bridges.maps.apart import Refused
from irsim.bridges.maps.kinds._gltf_scene import SceneReader

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], "<f4")


def description(**changes: Any) -> dict[str, Any]:
    content = {
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 5}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 1, "byteLength": 16}],
    }
    return content | changes


def read(content: dict[str, Any], *more: bytes, most: int = 100) -> np.ndarray:
    parts = SceneReader(content, [CORNERS.tobytes(), *more], most).triangles()
    return np.concatenate(
        [(points @ m[:3, :3].T + m[:3, 3])[faces] for points, faces, m in parts] or [np.zeros((0, 3, 3))]
    )


def test_strips_and_fans_face_one_way() -> None:
    for mode, count in ((5, 2), (6, 2), (1, 0)):
        meshes = [{"primitives": [{"attributes": {"POSITION": 0}, "mode": mode}]}]
        a, b, c = read(description(meshes=meshes)).transpose(1, 0, 2)
        assert len(a) == count
        if mode == 5:
            assert np.cross(b - a, c - a)[:, 2] == pytest.approx(1)


def test_hidden_nodes_and_instances() -> None:
    hidden = {"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": False}}, "children": [1]}
    assert not len(read(description(nodes=[hidden, {"mesh": 0}])))
    copies = {"mesh": 0, "translation": [0, 0, 5]}
    copies["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}
    triangles = read(description(nodes=[copies]))
    assert len(triangles) == 8
    np.testing.assert_allclose(triangles[::2, 0], CORNERS + np.array([0, 0, 5]))
    with pytest.raises(Refused, match="more than 7 triangles"):
        read(description(nodes=[copies]), most=7)


def test_sparse_and_quantized_values() -> None:
    sparse = {
        "count": 1,
        "indices": {"bufferView": 1, "componentType": 5125},
        "values": {"bufferView": 1, "byteOffset": 4},
    }
    accessors = [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4, "sparse": sparse}]
    change = np.array([3], "<u4").tobytes() + np.array([7, 8, 9], "<f4").tobytes()
    assert read(description(accessors=accessors), change).max() == 9
    views = [{"buffer": 1, "byteLength": 16, "byteStride": 4}]
    accessors = [{"bufferView": 0, "componentType": 5120, "type": "VEC3", "count": 4, "normalized": True}]
    packed = np.array([[-127, -127, 0, 0], [127, 0, 0, 0], [0, 127, 0, 0], [-128, 64, 0, 0]], "i1").tobytes()
    triangles = read(description(accessors=accessors, bufferViews=views), packed.ljust(16, b"\0"))
    assert (triangles.min(), triangles.max()) == (-1, 1)


@pytest.mark.parametrize("count", [10**12, -1, 5])
def test_values_that_are_not_there(count) -> None:
    accessors = [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": count}]
    with pytest.raises(Refused, match=r"promises|room for fewer"):
        read(description(accessors=accessors))
