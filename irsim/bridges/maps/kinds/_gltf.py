"""Opens a glTF file: it has the content that it declares, which is checked before anything is allocated."""

from __future__ import annotations

import binascii
import re
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.kinds._gltf_scene import MESHOPT, SceneReader
from irsim.bridges.maps.named_files import lies_in, with_root
from irsim.bridges.maps.source import ImportLimits, unusable
from irsim.common.records import ContentError, read_json
from irsim.common.text import clean
from irsim.scenario.locate import why_outside

__all__ = ["open_scene"]

_MAX_JSON = 128 * 1024**2
_SIZES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
_COUNTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_DATA = re.compile(r"data:[^,]{0,200};base64,")


@dataclass
class _Files:
    """The files that a scene is made of.

    Attributes:
        path: The file of the scene.
        root: A second folder whose files a ``.gltf`` may refer to, besides its own one; None for none.
        limits: How large they may be.
        named: Name in the description -> file.
    """

    path: Path
    root: Path | None
    limits: ImportLimits
    named: dict[str, Path] = field(default_factory=dict)


def open_scene(path: Path, limits: ImportLimits, root: Path | None = None) -> SceneReader:
    """Check a ``.glb`` or ``.gltf`` file, and read its buffers.

    Args:
        path: The file.
        limits: How much it may cost.
        root: A second folder whose files a ``.gltf`` may refer to, besides its own one; None for none.

    Returns:
        The reader of its triangles.

    Raises:
        BridgeError: Something in it does not fit, or refers to other places.
    """
    content, binary, start = _content(path)
    try:
        files = _Files(path, root, limits)
        _check(files, content, binary)
        buffers = [_bytes(path, item, files.named, start) for item in content.get("buffers", [])]
    except BridgeError:
        raise
    except (AttributeError, IndexError, KeyError, TypeError, ValueError, OverflowError, RecursionError) as error:
        raise unusable(path, f"its description is damaged ({type(error).__name__}: {str(error)[:80]})") from None
    return SceneReader(content, buffers, limits.triangles)


def _bytes(path: Path, item: dict[str, Any], names: dict[str, Path], start: int) -> bytes:
    """Content of a buffer that was checked."""
    uri, length = item.get("uri"), int(item["byteLength"])
    if _is_fallback(item):
        return b""
    if uri is not None:
        return binascii.a2b_base64(uri[data.end() :]) if (data := _DATA.match(uri)) else names[uri].read_bytes()
    with path.open("rb") as file:
        file.seek(start)
        return file.read(length)


def _is_fallback(item: dict[str, Any]) -> bool:
    """Whether a buffer only stands for what is packed in another one."""
    return "uri" not in item and any(name in item.get("extensions", {}) for name in MESHOPT)


def _content(path: Path) -> tuple[Any, int | None, int]:
    """The description, the size of the binary part of a ``.glb`` (None for a ``.gltf``), and where that part begins."""
    size, binary, start = path.stat().st_size, None, 0
    with path.open("rb") as file:
        if path.suffix.lower() == ".glb":
            head = file.read(20)
            if len(head) < 20 or head[:4] != b"glTF":
                raise unusable(path, f"its header of 20 bytes is missing or ends after {len(head)}")
            version, total, length, kind = struct.unpack("<4xIII4s", head)
            if version != 2:
                raise unusable(path, f"it has version {version} of glTF", "export it as glTF 2.0")
            if kind != b"JSON" or 20 + length > size or total > size:
                what = f"it ends after {size:,} bytes, and its header promises {max(total, 20 + length):,}"
                raise unusable(path, what)
            start = 20 + length
            if start + 8 <= size:
                file.seek(start)
                chunk, name = struct.unpack("<I4s", file.read(8))
                if start + 8 + chunk > size:
                    raise unusable(path, f"its binary part of {chunk:,} bytes ends after {size - start - 8:,}")
                binary = chunk if name == b"BIN\0" else None
            binary = binary or 0
            file.seek(20)
        else:
            length = size
        if length > _MAX_JSON:
            raise unusable(path, f"its description has {length:,} bytes, and at most {_MAX_JSON:,} are read")
        raw = file.read(length)
    try:
        content = read_json(raw)
    except ContentError as error:
        raise unusable(path, f"its description cannot be read: {error.message}") from None
    if not isinstance(content, dict):
        raise unusable(path, "its description is not a mapping")
    return content, binary, start + 8


def _check(files: _Files, content: dict[str, Any], binary: int | None) -> None:
    """Check a description, and find the files that it names."""
    path, limits = files.path, files.limits
    buffers = [_buffer(files, k, item, binary) for k, item in enumerate(content.get("buffers", []))]
    views = []
    for k, view in enumerate(content.get("bufferViews", [])):
        begin, length = int(view.get("byteOffset", 0)), int(view["byteLength"])
        packed = any(name in view.get("extensions", {}) for name in MESHOPT)
        if begin < 0 or length < 0 or (not packed and begin + length > buffers[_index(view["buffer"])]):
            raise unusable(path, f"its part bufferViews[{k}] reaches beyond its buffer")
        views.append((length, int(view.get("byteStride", 0))))
    counts = [_accessor(path, k, item, views) for k, item in enumerate(content.get("accessors", []))]
    triangles = [_triangles(mesh, counts) for mesh in content.get("meshes", [])]
    nodes = content.get("nodes", [])
    parents = [0] * len(nodes)
    for node in nodes:
        for child in node.get("children", []):
            parents[_index(child)] += 1
    if max(parents, default=0) > 1:
        raise unusable(path, f"its node {parents.index(max(parents))} has several parents")
    for root in {_index(node) for scene in content.get("scenes", []) for node in scene.get("nodes", [])}:
        if parents[root]:  # without this check nodes could go round in circles
            raise unusable(path, f"its node {root} is below another one, or itself")
    total = sum(triangles[_index(node["mesh"])] for node in nodes if "mesh" in node)
    if total > limits.triangles:
        what = f"it has {total:,} triangles, and at most {limits.triangles:,} are read"
        raise unusable(path, what, "simplify the mesh")


def _buffer(files: _Files, k: int, item: dict[str, Any], binary: int | None) -> int:
    """Size of a buffer [bytes]."""
    length, uri = int(item["byteLength"]), item.get("uri")
    if _is_fallback(item):
        have = length
    elif uri is None:
        have = binary if binary is not None and k == 0 else 0
    elif (data := _DATA.match(uri)) is not None:
        try:
            have = len(binascii.a2b_base64(uri[data.end() :]))
        except binascii.Error:
            have = 0
    else:
        have = _named_file(files, uri, binary)
    if length < 0 or length > have:
        raise unusable(files.path, f"its part buffers[{k}] promises {length:,} bytes and has {have:,}")
    return length


def _named_file(files: _Files, uri: str, binary: int | None) -> int:
    """Size of a file that a ``.gltf`` names, in its own folder, in the root, or below them."""
    path, name, shown = files.path, unquote(uri), clean(uri, 100)
    file = path.parent / name
    fix = "export it as .glb with everything inside"
    why = "a .glb has all in itself" if binary is not None else None
    if why is None and re.match(r"[A-Za-z][A-Za-z0-9+.-]*:", name):
        why = "addresses are not followed"
    if why is None and not lies_in(file, [files.root]):
        outside = why_outside(name, path.parent)
        why = None if outside is None else f"the name {outside}"
        if outside is not None and name.isprintable():
            fix = with_root(fix, path.resolve().parent, file)
    if why is not None:
        raise BridgeError("bridge-file", f"'{path.name}' refers to '{shown}', which is not read: {why}", fix)
    if not file.is_file():
        raise unusable(path, f"there is no file '{shown}' beside it", "keep the files of a .gltf together")
    size = file.stat().st_size
    if size > files.limits.bytes:
        raise unusable(path, f"'{shown}' has {size:,} bytes, and at most {files.limits.bytes:,} are read")
    files.named[uri] = files.named[name] = file
    return size


def _accessor(path: Path, k: int, item: dict[str, Any], views: list[tuple[int, int]]) -> int:
    """Number of values of an accessor, all of which are there."""
    count, begin = int(item["count"]), int(item.get("byteOffset", 0))
    size = _SIZES[item["componentType"]] * _COUNTS[item["type"]]
    if "bufferView" not in item:
        if count < 0 or begin < 0:
            raise unusable(path, f"its part accessors[{k}] promises {count:,} values, and there is room for fewer")
        return count
    length, stride = views[_index(item["bufferView"])]
    need = begin + (count - 1) * max(stride, size) + size if count else 0
    if count < 0 or begin < 0 or need > length:
        raise unusable(path, f"its part accessors[{k}] promises {count:,} values, and there is room for fewer")
    return count


def _triangles(mesh: dict[str, Any], counts: list[int]) -> int:
    total = 0
    for primitive in mesh.get("primitives", []):
        values = primitive.get("indices", primitive.get("attributes", {}).get("POSITION"))
        mode = primitive.get("mode", 4)
        total += 0 if values is None else counts[_index(values)] // (3 if mode == 4 else 1)
    return total


def _index(value: Any) -> int:
    if type(value) is not int or value < 0:
        raise ValueError(f"{value!r} is not an index")
    return value
