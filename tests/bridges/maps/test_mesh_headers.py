"""Headers of meshes are checked before a library reads the file: sizes, counts, other places, compression."""

from __future__ import annotations

import json
import re
import struct
import tracemalloc
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.kinds import _gltf, _headers
from irsim.bridges.maps.source import ImportLimits
from tests.bridges.maps.scenes import box, write_glb

LIMITS = ImportLimits()
BOX = box([0, 0, 0], [2, 2, 1])


def refused(path: Path, said: str, limits: ImportLimits = LIMITS) -> None:
    tracemalloc.start()
    with pytest.raises(BridgeError, match=said) as caught:
        _gltf.open_scene(path, limits)
    assert caught.value.code == "bridge-file"
    assert tracemalloc.get_traced_memory()[1] < 1 << 21
    tracemalloc.stop()


def test_a_good_file_passes(tmp_path) -> None:
    assert (
        sum(len(faces) for _, faces, _ in _gltf.open_scene(write_glb(tmp_path / "box.glb", BOX), LIMITS).triangles())
        == 12
    )


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        ("accessors.0.count", 10**12, "accessors.0. promises"),
        ("accessors.0.count", -1, "accessors.0. promises"),
        ("accessors.0.byteOffset", -8, "accessors.0. promises"),
        ("accessors.0.componentType", 1, "description is damaged"),
        ("accessors.0.type", "VEC9", "description is damaged"),
        ("bufferViews.0.byteLength", 10**12, "reaches beyond"),
        ("bufferViews.0.byteOffset", -1, "reaches beyond"),
        ("bufferViews.0.buffer", 3, "description is damaged"),
        ("bufferViews.0.buffer", -1, "description is damaged"),
        ("buffers.0.byteLength", 10**10, "buffers.0. promises 10,000,000,000"),
        ("buffers.0.uri", "file:///etc/passwd", "not read"),
        ("buffers.0.uri", "http://127.0.0.1:9/x.bin", "not read"),
        ("buffers.0.uri", "other.bin", "a .glb has all in itself"),
        ("buffers.0.uri", "data:application/octet-stream;base64,AAAA", "buffers.0. promises"),
        ("nodes.0.children", [0], "node 0"),
        ("nodes.0.mesh", 7, "description is damaged"),
        ("nodes", [{"children": [1, 1]}, {"mesh": 0}], "several parents"),
        ("nodes", [{"children": [1]}, {"children": [0]}], "node 0"),
        ("nodes", "x", "description is damaged"),
        ("meshes", {"a": 1}, "description is damaged"),
    ],
)
def test_what_a_description_promises(tmp_path, path, value, said) -> None:
    def change(content) -> None:
        *way, last = path.split(".")
        for step in way:
            content = content[int(step) if step.isdigit() else step]
        content[last] = value

    file = write_glb(tmp_path / "box.glb", BOX, change=change)
    refused(file, said)


def test_copies_count(tmp_path) -> None:
    file = write_glb(tmp_path / "box.glb", BOX, change=lambda content: content.update(nodes=[{"mesh": 0}] * 50))
    refused(file, "600 triangles", ImportLimits(triangles=500))


def test_a_file_that_ends_anywhere_is_refused(tmp_path) -> None:
    content = write_glb(tmp_path / "box.glb", BOX).read_bytes()
    for length in [*range(0, len(content), 9), len(content) - 1]:
        (tmp_path / "short.glb").write_bytes(content[:length])
        with pytest.raises(BridgeError):
            _gltf.open_scene(tmp_path / "short.glb", LIMITS)


@given(data=st.data())
@settings(max_examples=100, deadline=None)
def test_changed_bytes_pass_or_give_a_clear_error(tmp_path_factory, data) -> None:
    folder = tmp_path_factory.mktemp("glb")
    content = bytearray(write_glb(folder / "box.glb", BOX).read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, 700))] = data.draw(st.integers(0, 255))
    (folder / "box.glb").write_bytes(content)
    with suppress(BridgeError):
        _gltf.open_scene(folder / "box.glb", LIMITS)


def test_a_gltf_may_have_files_beside_it_only(tmp_path) -> None:
    folder = tmp_path / "scene"
    folder.mkdir()
    (tmp_path / "secret.bin").write_bytes(bytes(99))
    (folder / "own.bin").write_bytes(bytes(99))
    (folder / "link.bin").symlink_to(tmp_path / "secret.bin")
    file = folder / "scene.gltf"
    for uri, said in [
        ("own.bin", None),
        ("own%2Ebin", None),
        ("missing.bin", "no file"),
        ("../secret.bin", "leads upwards"),
        ("%2e%2e/secret.bin", "leads upwards"),
        (str(tmp_path / "secret.bin"), "absolute"),
        ("link.bin", "link"),
        ("https://example.org/x.bin", "not followed"),
        ("file:own.bin", "not followed"),
    ]:
        file.write_text(json.dumps({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 99, "uri": uri}]}))
        if said is None:
            _gltf.open_scene(file, LIMITS)
        else:
            refused(file, said)
    (folder / "scene.gltf").write_text("[" * 100_000)
    refused(file, "not valid JSON")


def test_a_gltf_may_have_files_below_the_root(tmp_path) -> None:
    file = tmp_path / "show" / "scenes" / "scene.gltf"
    for folder in ("show/scenes", "show/data", "secret"):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "a.bin").write_bytes(bytes(99))
    (tmp_path / "show/data/link.bin").symlink_to(tmp_path / "secret/a.bin")
    root = (tmp_path / "show").resolve()

    def named(uri: str) -> None:
        file.write_text(json.dumps({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 99, "uri": uri}]}))

    for uri in ("a.bin", "../data/a.bin", "..%2Fdata/a.bin", str(root / "data/a.bin")):
        named(uri)
        _gltf.open_scene(file, LIMITS, root)
    named("../data/a.bin")
    with pytest.raises(BridgeError, match=f"leads upwards.*--root {re.escape(str(root))} if"):
        _gltf.open_scene(file, LIMITS)
    for uri, said in (
        ("../../secret/a.bin", "leads upwards"),
        ("../data/link.bin", "leads upwards"),
        (str(tmp_path / "secret/a.bin"), "absolute"),
        ("file:../data/a.bin", "not followed"),
        ("../data/none.bin", "no file"),
    ):
        named(uri)
        with pytest.raises(BridgeError, match=said):
            _gltf.open_scene(file, LIMITS, root)


VERTEX = "property float x\nproperty float y\nproperty float z\n"
FACE = "property list uchar int vertex_indices\n"


@pytest.mark.parametrize(
    ("header", "said"),
    [
        (
            f"format binary_little_endian 1.0\nelement vertex {10**9}\n{VERTEX}element face 9\n{FACE}",
            "promises at least",
        ),
        (f"format ascii 1.0\nelement vertex 3\n{VERTEX}element face 4000000000\n{FACE}", "promises at least"),
        (f"format ascii 1.0\nelement vertex -3\n{VERTEX}", "line 3"),
        (f"format ascii 1.0\nelement vertex x\n{VERTEX}", "line 3"),
        ("format ascii 1.0\nelement vertex 3\nproperty quad x\n", "line 4"),
        ("property float x\n", "line 2"),
        (f"format ascii 1.0\nelement vertex 3\n{VERTEX}", "no faces"),
        (f"format ascii 1.0\nelement vertex 3\n{VERTEX}property float f_dc_0\n", "Gaussian splats"),
    ],
)
def test_ply_headers(tmp_path, header, said) -> None:
    file = tmp_path / "scan.ply"
    file.write_bytes(f"ply\n{header}end_header\n".encode() + bytes(300))
    with pytest.raises(BridgeError, match=said):
        _headers.check_ply(file)
    file.write_bytes(b"ply\nformat ascii 1.0\n")
    with pytest.raises(BridgeError, match="no line 'end_header'"):
        _headers.check_ply(file)


def test_stl_headers(tmp_path) -> None:
    file = tmp_path / "part.stl"
    for content, said in [
        (bytes(50), "ends within its header"),
        (bytes(80) + struct.pack("<I", 2**32 - 1) + bytes(50), "4,294,967,295 triangles"),
        (b"solid x".ljust(80) + struct.pack("<I", 1) + bytes(50), None),
        (b"solid x\nendsolid\n", None),
    ]:
        file.write_bytes(content)
        if said is None:
            _headers.check_stl(file)
        else:
            with pytest.raises(BridgeError, match=said):
                _headers.check_stl(file)
