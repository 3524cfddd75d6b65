"""Files of splats: what is read, and what is refused."""

from __future__ import annotations

import math
import tracemalloc
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.bridges.base import BridgeError
from irsim.bridges.splats.reading import read_splats
from tests.bridges.splats.scenes import FIELDS, table, write_ply

ROWS = table([
    [1, 2, 3, 0.2, 0.4, 0.6, 0.9, 0.1, 0.2, 0.3, 1, 0, 0, 0],
    [-1, 0, 5, 0.5, 0.5, 0.5, 0.25, 0.01, 0.02, 3, 0, 2, 0, 0],
])  # fmt: skip


@pytest.mark.parametrize("encoding", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_a_file_is_read_by_hand(tmp_path: Path, encoding: str) -> None:
    splats = read_splats(write_ply(tmp_path / "a.ply", ROWS, encoding=encoding))
    assert splats.center.tolist() == [[1, 2, 3], [-1, 0, 5]]
    np.testing.assert_allclose(splats.color, [[0.2, 0.4, 0.6], [0.5, 0.5, 0.5]], atol=1e-6)
    np.testing.assert_allclose(splats.opacity, [0.9, 0.25], atol=1e-6)
    np.testing.assert_allclose(splats.scale, [[0.1, 0.2, 0.3], [0.01, 0.02, 3]], rtol=1e-5)
    assert splats.rotation.tolist() == [[1, 0, 0, 0], [0, 1, 0, 0]]  # normalized
    assert splats.harmonics is None


def test_doubles_other_columns_and_windows_lines_are_no_hindrance(tmp_path: Path) -> None:
    fields = [*FIELDS, "label"]
    columns = np.column_stack([ROWS, [7, 9]])
    path = write_ply(tmp_path / "a.ply", columns, fields=fields, kinds={"x": "double", "label": "uchar"})
    head, _, body = path.read_bytes().partition(b"end_header\n")
    path.write_bytes(head.replace(b"\n", b"\r\n") + b"end_header\r\n" + body)
    assert read_splats(path).center.tolist() == [[1, 2, 3], [-1, 0, 5]]


def test_harmonics_are_all_red_ones_first(tmp_path: Path) -> None:
    fields = [*FIELDS, *(f"f_rest_{number}" for number in range(9))]
    rest = np.arange(18.0).reshape(2, 9)
    path = write_ply(tmp_path / "a.ply", np.column_stack([ROWS, rest]), fields=fields)
    assert read_splats(path).harmonics is None
    harmonics = read_splats(path, harmonics=True).harmonics
    assert harmonics is not None
    assert harmonics[0].tolist() == [[0, 3, 6], [1, 4, 7], [2, 5, 8]]  # coefficient, then red, green, blue


def test_an_infinite_logit_is_an_opacity_of_one(tmp_path: Path) -> None:
    rows = ROWS.copy()
    rows[:, FIELDS.index("opacity")] = [math.inf, -math.inf]
    assert read_splats(write_ply(tmp_path / "a.ply", rows)).opacity.tolist() == pytest.approx([1, 0])


def with_value(name: str, value: float) -> np.ndarray:
    rows = ROWS.copy()
    rows[1, FIELDS.index(name)] = value
    return rows


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("x", math.nan, "splat 1: 'x' is nan"),
        ("scale_2", math.inf, "splat 1: 'scale_2' is inf"),
        ("scale_2", 60.0, "splat 1: 'scale_2' is 60"),
        ("opacity", math.nan, "splat 1: 'opacity' is nan"),
        ("y", 1e20, "splat 1: 'y' is 1e+20"),
        ("rot_1", 0.0, "splat 1: its quaternion has no direction"),
    ],
)
@pytest.mark.parametrize("encoding", ["ascii", "binary_little_endian"])
def test_values_that_are_none_are_named(tmp_path: Path, name: str, value: float, message: str, encoding: str) -> None:
    with pytest.raises(BridgeError, match="splat 1") as raised:
        read_splats(write_ply(tmp_path / "a.ply", with_value(name, value), encoding=encoding))
    assert raised.value.code == "bridge-file"
    assert message in str(raised.value)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"element vertex 2", b"element vertex 10000000", "10,000,000 splats as in its header take 680,000,"),
        (b"element vertex 2", b"element vertex 999999999999", "at most 20,000,000"),
        (b"element vertex 2", b"element vertex 99999999999999999999", "line 4: this line is not one of a PLY header"),
        (b"element vertex 2", b"element vertex -1", "line 4: this line"),
        (b"element vertex 2", b"element vertex 0", "it has no splats"),
        (b"element vertex 2", b"element point 2", "no element 'vertex'"),
        (b"property float opacity\n", b"", "no opacity"),
        (b"property float opacity\n", b"property int opacity\n", "'opacity' is of the type int"),
        (b"property float opacity\n", b"property float f_dc_0\n", "the property 'f_dc_0' twice"),
        (b"property float nx\n", b"property list uchar int nx\n", "lists"),
        (b"property float x\n", b"property uint packed_position\nproperty float x\n", "compressed"),
        (b"property float nx\n", b"property float f_rest_0\n", "1 properties f_rest_*"),
        (b"format binary_little_endian 1.0\n", b"", "no line 'format'"),
        (b"format binary_little_endian 1.0\n", b"format morse 1.0\n", "line 2"),
        (b"element vertex", b"element face 3\nproperty list uchar int vertex_indices\nelement vertex", "'face' stands"),
        (b"end_header\n", b"", "no line 'end_header'"),
        (b"ply\n", b"gltf\n", "does not begin with 'ply'"),
    ],
)
def test_headers_that_lie_are_refused_without_memory(tmp_path: Path, old: bytes, new: bytes, message: str) -> None:
    path = write_ply(tmp_path / "a.ply", ROWS)
    raw = path.read_bytes()
    assert old in raw
    path.write_bytes(raw.replace(old, new, 1))
    tracemalloc.start()
    try:
        with pytest.raises(BridgeError) as raised:
            read_splats(path, harmonics=True)
        assert message in str(raised.value)
        assert tracemalloc.get_traced_memory()[1] < 5e6
    finally:
        tracemalloc.stop()


def test_a_truncated_file_says_how_far_it_goes(tmp_path: Path) -> None:
    path = write_ply(tmp_path / "a.ply", ROWS)
    path.write_bytes(path.read_bytes()[:-5])
    with pytest.raises(BridgeError, match="but 2 splats as in its header take"):
        read_splats(path)
    write_ply(path, ROWS[:1], encoding="ascii", count=2)
    path.write_bytes(path.read_bytes() + b" " * 40)
    with pytest.raises(BridgeError, match="it ends after 1 of 2 splats"):
        read_splats(path)


def test_words_that_are_no_numbers_are_refused(tmp_path: Path) -> None:
    path = write_ply(tmp_path / "a.ply", ROWS, encoding="ascii")
    path.write_bytes(path.read_bytes().replace(b"-1.0 ", b"minus ", 1))
    with pytest.raises(BridgeError, match="minus"):
        read_splats(path)
    path.write_bytes(path.read_bytes().replace(b"minus", b"1" * 3_000_000, 1))
    with pytest.raises(BridgeError, match="more than 64 characters"):
        read_splats(path)


def test_a_file_that_is_not_there_and_a_folder_are_errors(tmp_path: Path) -> None:
    for path in (tmp_path / "none.ply", tmp_path):
        with pytest.raises(BridgeError, match="cannot be read"):
            read_splats(path)


@given(data=st.data(), encoding=st.sampled_from(["ascii", "binary_little_endian"]))
def test_damaged_files_are_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject, encoding: str
) -> None:
    path = write_ply(tmp_path_factory.mktemp("damaged") / "a.ply", ROWS, encoding=encoding)
    raw = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        raw[data.draw(st.integers(0, len(raw) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(raw[: data.draw(st.integers(0, len(raw)))])
    with suppress(BridgeError):
        splats = read_splats(path, harmonics=True)
        for values in (splats.center, splats.scale, splats.rotation, splats.opacity, splats.color):
            assert np.isfinite(values).all()
