"""Triangles of a glTF description that was checked: packed and quantized meshes, instances, strips and fans.

Source: Khronos Group, glTF 2.0 specification, with the extensions ``KHR_draco_mesh_compression``,
``KHR_mesh_quantization``, ``EXT_meshopt_compression``, ``EXT_mesh_gpu_instancing`` and ``KHR_node_visibility``.
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.maps.apart import Refused
from irsim.common.arrays import Floats
from irsim.common.extras import require

__all__ = ["MESHOPT", "SceneReader"]

MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression")
_CODES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COUNTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_DRACO = "KHR_draco_mesh_compression"
_FANS = {4: "triangles", 5: "strips", 6: "fans"}
"""Modes of primitives that have surfaces."""


class SceneReader:
    """Reads the triangles of a description.

    Args:
        content: The description.
        buffers: Content of each buffer; empty for a buffer that only stands for packed data.
        most: Largest number of triangles.
    """

    def __init__(self, content: dict[str, Any], buffers: list[bytes], most: int) -> None:
        self._content, self._buffers, self._most = content, buffers, most
        self._room = most
        self._meshes: dict[int, list[tuple[Floats, NDArray[np.int64]]]] = {}

    def triangles(self) -> Iterator[tuple[Floats, NDArray[np.int64], Floats]]:
        """Yield points (P, 3), faces (F, 3) and the transform (4, 4) of each part of the scene that is drawn."""
        nodes = self._content.get("nodes", [])
        waiting = [(root, np.eye(4)) for root in reversed(self._roots(nodes))]
        while waiting:
            number, above = waiting.pop()
            node = nodes[number]
            extensions = node.get("extensions", {})
            if extensions.get("KHR_node_visibility", {}).get("visible", True) is False:
                continue
            place = above @ _transform(node)
            waiting += [(child, place) for child in reversed(node.get("children", []))]
            if "mesh" not in node:
                continue
            copies = self._instances(extensions.get("EXT_mesh_gpu_instancing"))
            for points, faces in self._mesh(node["mesh"]):
                self._room -= len(faces) * len(copies)
                if self._room < 0:
                    raise Refused(f"it has more than {self._most:,} triangles", "simplify the mesh")
                for copy in copies:
                    yield points, faces, place @ copy

    def _roots(self, nodes: list[Any]) -> list[int]:
        scenes = self._content.get("scenes", [])
        if scenes:
            roots: list[int] = scenes[self._content.get("scene", 0)].get("nodes", [])
            return roots
        below = {child for node in nodes for child in node.get("children", [])}
        return [number for number in range(len(nodes)) if number not in below]

    def _instances(self, extension: dict[str, Any] | None) -> list[Floats]:
        """Transforms of the copies of a node's mesh."""
        if extension is None:
            return [np.eye(4)]
        given = {name: self._accessor(index) for name, index in extension.get("attributes", {}).items()}
        parts = [given.get(name) for name in ("TRANSLATION", "ROTATION", "SCALE")]
        counts = {len(part) for part in parts if part is not None}
        if len(counts) != 1:
            raise Refused(f"its instances have {sorted(counts)} places, turns and sizes")
        names = ("translation", "rotation", "scale")
        rows = range(counts.pop())
        return [_transform({n: p[k] for n, p in zip(names, parts, strict=True) if p is not None}) for k in rows]

    def _mesh(self, number: int) -> list[tuple[Floats, NDArray[np.int64]]]:
        if number not in self._meshes:
            primitives = self._content["meshes"][number].get("primitives", [])
            drawn = [part for part in primitives if part.get("mode", 4) in _FANS]
            self._meshes[number] = [self._primitive(part) for part in drawn if "POSITION" in part["attributes"]]
        return self._meshes[number]

    def _primitive(self, part: dict[str, Any]) -> tuple[Floats, NDArray[np.int64]]:
        """Points and faces of a primitive."""
        packed = part.get("extensions", {}).get(_DRACO)
        if packed is not None:
            points, order = self._draco(packed)
        else:
            points = self._accessor(part["attributes"]["POSITION"])
            order = np.arange(len(points))
            if "indices" in part:
                order = self._accessor(part["indices"])[:, 0].astype(np.int64)
        mode = part.get("mode", 4)
        if mode == 4 or packed is not None:
            faces = order[: len(order) // 3 * 3].reshape(-1, 3)
        elif mode == 5:
            faces = np.stack([order[:-2], order[1:-1], order[2:]], axis=1)
            faces[1::2] = faces[1::2, ::-1]
        else:
            faces = np.stack([np.broadcast_to(order[:1], len(order[2:])), order[1:-1], order[2:]], axis=1)
        return points, faces

    def _draco(self, packed: dict[str, Any]) -> tuple[Floats, NDArray[np.int64]]:
        require("mesh", "DracoPy")
        mesh = import_module("DracoPy").decode(self._view(packed["bufferView"]).tobytes())
        points = np.asarray(mesh.points, dtype=np.float64).reshape(-1, 3)
        return points, np.asarray(getattr(mesh, "faces", []), dtype=np.int64).reshape(-1)

    def _view(self, number: int) -> NDArray[np.uint8]:
        """Bytes of a buffer view, unpacked."""
        view = self._content["bufferViews"][number]
        packed = next((view["extensions"][name] for name in MESHOPT if name in view.get("extensions", {})), None)
        source = view if packed is None else packed
        begin, length = int(source.get("byteOffset", 0)), int(source["byteLength"])
        data = self._buffers[source["buffer"]]
        if begin < 0 or length < 0 or begin + length > len(data):
            raise Refused(f"its part bufferViews[{number}] reaches beyond its buffer")
        if packed is None:
            return np.frombuffer(data, np.uint8, length, begin)
        return _unpacked(packed, data[begin : begin + length])

    def _accessor(self, number: int) -> Floats:
        """(count, components) values of an accessor; normalized integers are scaled."""
        item = self._content["accessors"][number]
        code, width, count = np.dtype(_CODES[item["componentType"]]), _COUNTS[item["type"]], int(item["count"])
        if not 0 <= count <= 3 * self._most:
            raise Refused(f"its part accessors[{number}] promises {count:,} values", "simplify the mesh")
        values = np.zeros((count, width), code)
        if "bufferView" in item:
            stride = int(self._content["bufferViews"][item["bufferView"]].get("byteStride", 0)) or width * code.itemsize
            values = self._rows(item["bufferView"], int(item.get("byteOffset", 0)), code, (count, width), stride).copy()
        if "sparse" in item:
            sparse, changed = item["sparse"], int(item["sparse"]["count"])
            kind = np.dtype(_CODES[sparse["indices"]["componentType"]])
            where = self._packed_rows(sparse["indices"], kind, (changed, 1))[:, 0].astype(np.int64)
            values[where] = self._packed_rows(sparse["values"], code, (changed, width))
        if item.get("normalized") and code.kind in "iu":
            return np.maximum(values / float(np.iinfo(code).max), -1.0)
        return values.astype(np.float64)

    def _packed_rows(self, part: dict[str, Any], code: np.dtype[Any], shape: tuple[int, int]) -> NDArray[Any]:
        offset = int(part.get("byteOffset", 0))
        return self._rows(part["bufferView"], offset, code, shape, shape[1] * code.itemsize)

    def _rows(self, view: int, offset: int, code: np.dtype[Any], shape: tuple[int, int], stride: int) -> NDArray[Any]:
        data, (count, width) = self._view(view), shape
        if min(count, offset, stride) < 0 or offset + (count - 1) * stride + width * code.itemsize > len(data):
            if count:
                raise Refused(f"its part bufferViews[{view}] has room for fewer than {count:,} values")
            return np.zeros(shape, code)
        return np.ndarray(shape, code, data, offset, (stride, code.itemsize))


def _unpacked(packed: dict[str, Any], data: bytes) -> NDArray[np.uint8]:
    """Bytes that the library meshoptimizer has packed."""
    if find_spec("meshoptimizer") is None:
        fix = "install the library, which needs a compiler: pip install --pre meshoptimizer; or unpack the file: npx "
        fix += "@gltf-transform/cli copy scene.glb plain.glb"
        raise Refused("its geometry is packed with EXT_meshopt_compression, and meshoptimizer is not installed", fix)
    library = import_module("meshoptimizer")
    count, stride = int(packed["count"]), int(packed["byteStride"])
    if count < 0 or not 1 <= stride <= 256 or count * stride > 1 << 32:
        raise Refused(f"it promises {count:,} packed values of {stride} bytes")
    if packed["mode"] != "ATTRIBUTES":
        decode = library.decode_index_buffer if packed["mode"] == "TRIANGLES" else library.decode_index_sequence
        order = np.asarray(decode(count, 4, data)).astype("<u2" if stride == 2 else "<u4")
        return np.frombuffer(order.tobytes(), np.uint8)
    values = np.ascontiguousarray(library.decode_vertex_buffer(count, stride, data))
    raw = np.frombuffer(values.tobytes(), np.uint8).copy()
    if packed.get("filter", "NONE") == "EXPONENTIAL":
        words = raw.view("<i4")
        raw = np.ldexp((words << 8 >> 8).astype(np.float64), words >> 24).astype("<f4").view(np.uint8)
    return raw  # other filters are of normals and turns


def _transform(node: dict[str, Any]) -> Floats:
    """(4, 4) transform of a node, or of an instance."""
    if "matrix" in node:
        return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    result = np.eye(4)
    x, y, z, w = (float(value) for value in node.get("rotation", (0, 0, 0, 1)))
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    result[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)), dtype=np.float64)
    result[:3, 3] = node.get("translation", (0, 0, 0))
    return result
