"""Files of splats, which are read or refused, pictures of splats, and what is written about them."""

from __future__ import annotations

import math
import re
import shlex
import tracemalloc
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from irsim.bridges.base import BridgeError
from irsim.bridges.frames import FRAMES, axes_of, camera_pose
from irsim.bridges.splats import render
from irsim.bridges.splats.reading import read_splats
from irsim.bridges.splats.render import View, colors_seen, picture
from irsim.bridges.splats.splats import Splats, covariance_of, join_splats, moved, rotation_matrices, scale_of
from irsim.cli.app import app
from tests.bridges.splats.scenes import FIELDS, room, table, write_ply

NUMBERS = st.floats(-1, 1)


def some(count: int = 5, seed: int = 0, terms: int = 0) -> Splats:
    rng = np.random.default_rng(seed)
    quaternion = rng.normal(size=(count, 4))
    quaternion /= np.linalg.norm(quaternion, axis=1, keepdims=True)
    arrays = [rng.normal(size=(count, 3)), rng.uniform(0.1, 2, (count, 3)), quaternion, rng.uniform(0, 1, count)]
    arrays.append(rng.uniform(0, 1, (count, 3)))
    harmonics = rng.normal(size=(count, terms, 3)).astype(np.float32) if terms else None
    return Splats(*(values.astype(np.float32) for values in arrays), harmonics)


@given(frame=st.sampled_from(FRAMES), factor=st.sampled_from([0.1, 1.0, 30.0]), yaw=st.floats(-3, 3))
def test_moved_splats_have_the_moved_covariance(frame: str, factor: float, yaw: float) -> None:
    splats, transform = some(), np.eye(4)
    turn = np.array([[math.cos(yaw), -math.sin(yaw), 0], [math.sin(yaw), math.cos(yaw), 0], [0, 0, 1]])
    transform[:3, :3] = factor * axes_of(frame) @ turn
    transform[:3, 3] = [1, -2, 3]
    result = moved(splats, transform)
    assert scale_of(transform) == pytest.approx(factor)
    expected = covariance_of(splats.scale, splats.rotation, transform[:3, :3])
    size = float(np.abs(expected).max())
    np.testing.assert_allclose(covariance_of(result.scale, result.rotation), expected, atol=2e-5 * size)
    np.testing.assert_allclose(np.linalg.det(rotation_matrices(result.rotation)), 1, atol=1e-5)
    shifted = splats.center @ transform[:3, :3].T + transform[:3, 3]
    np.testing.assert_allclose(result.center, shifted, atol=1e-5 * factor + 1e-5)


def test_joined_splats_get_harmonics_of_zero() -> None:
    joined = join_splats([some(2), some(3, terms=3)])
    assert len(joined) == 5
    assert joined.harmonics is not None
    assert joined.harmonics.shape == (5, 3, 3)
    assert not joined.harmonics[:2].any()
    assert join_splats([some(2), some(1)]).harmonics is None


def test_harmonics_are_an_orthonormal_basis() -> None:
    rng = np.random.default_rng(0)
    steps = 400
    z = (np.arange(steps) + 0.5) / steps * 2 - 1  # equal areas of the sphere
    angle = np.arange(steps) * math.pi * (3 - math.sqrt(5)) + rng.uniform()
    direction = np.column_stack([np.sqrt(1 - z * z) * np.cos(angle), np.sqrt(1 - z * z) * np.sin(angle), z])
    direction = direction.astype(np.float32)
    values = np.stack([
        colors_seen(np.full((steps, 3), 9.0, np.float32), np.tile(one, (steps, 1, 1)), direction)[:, 0] - 9.0
        for one in np.eye(15, dtype=np.float32)[:, :, None].repeat(3, axis=2)
    ])  # fmt: skip
    np.testing.assert_allclose(4 * math.pi * values @ values.T / steps, np.eye(15), atol=0.02)


@pytest.mark.parametrize(("axis", "coefficient", "sign"), [(1, 0, -1), (2, 1, 1), (0, 2, -1)])
def test_the_first_degree_is_y_z_x_with_their_signs(axis: int, coefficient: int, sign: int) -> None:
    harmonics = np.zeros((1, 3, 3), np.float32)
    harmonics[0, coefficient] = 0.5
    direction = np.zeros((1, 3), np.float32)
    direction[0, axis] = 1
    seen = colors_seen(np.full((1, 3), 0.5, np.float32), harmonics, direction)
    assert seen[0] == pytest.approx(0.5 + sign * 0.5 * math.sqrt(3 / (4 * math.pi)))


AHEAD = camera_pose(np.array([0.0, 0.0, 0.0]), "colmap", 0.0)
"""Looks along x of irsim."""


def ball(center: list[float], color: list[float], sigma: float = 0.1, opacity: float = 0.9) -> Splats:
    return Splats(
        np.array([center], np.float32), np.full((1, 3), sigma, np.float32), np.array([[1, 0, 0, 0]], np.float32),
        np.array([opacity], np.float32), np.array([color], np.float32),
    )  # fmt: skip


def slow_picture(splats: Splats, view: View) -> np.ndarray:
    """The same by a loop over splats from front to back, with whole pictures."""
    to_camera = np.linalg.inv(view.matrix)
    place = splats.center @ to_camera[:3, :3].T + to_camera[:3, 3]
    x, y = np.meshgrid(np.arange(view.width) + 0.5, np.arange(view.rows) + 0.5)
    color, through = np.zeros((view.rows, view.width, 3)), np.ones((view.rows, view.width))
    cover = covariance_of(splats.scale, splats.rotation, to_camera[:3, :3])
    for row in np.argsort(place[:, 2]):
        depth = place[row, 2]
        if depth <= 0.05:
            continue
        slope = np.array([view.width, view.rows]) / 2 / view.focal
        tangent = np.clip(place[row, :2] / depth, -1.3 * slope, 1.3 * slope)
        jacobian = view.focal / depth * np.array([[1, 0, -tangent[0]], [0, 1, -tangent[1]]])
        form = np.linalg.inv(jacobian @ cover[row] @ jacobian.T + 0.3 * np.eye(2))
        middle = view.focal * place[row, :2] / depth + np.array([view.width, view.rows]) / 2
        dx, dy = x - middle[0], y - middle[1]
        square = form[0, 0] * dx * dx + 2 * form[0, 1] * dx * dy + form[1, 1] * dy * dy
        alpha = min(splats.opacity[row], 0.99) * np.exp(-0.5 * square)
        alpha[alpha < 1 / 255] = 0
        color += (through * alpha)[..., None] * splats.color[row]
        through *= 1 - alpha
    return np.round(255 * np.clip(color + through[..., None], 0, 1)).astype(np.uint8)


def test_the_nearer_splat_covers_the_farther_one() -> None:
    red, green = ball([2, 0, 0], [1, 0, 0]), ball([4, 0, 0], [0, 1, 0], sigma=0.4)
    shown = picture(join_splats([green, red]), View(AHEAD, 41, 31, 60.0))
    assert shown.shape == (31, 41, 3)
    # 0.9 of red, 0.9 of what is left of green, and the rest is white.
    assert shown[15, 20].tolist() == pytest.approx([255 * (0.9 + 0.01), 255 * (0.09 + 0.01), 255 * 0.01], abs=3)
    assert shown[0, 0].tolist() == [255, 255, 255]


def test_left_is_left_and_up_is_up() -> None:
    shown = picture(ball([2, 0.5, 0.4], [0, 0, 0]), View(AHEAD, 61, 61, 60.0))
    row, column = np.unravel_index(shown[..., 0].argmin(), (61, 61))
    assert (column, row) == (30 - 15, 30 - 12)


def test_what_is_behind_the_camera_is_not_seen() -> None:
    assert (picture(ball([-2, 0, 0], [0, 0, 0]), View(AHEAD, 20, 20, 20.0)) == 255).all()


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_pictures_are_those_of_a_plain_loop(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    splats = some(120, seed)
    splats.center[:] += [4, 0, 0]
    splats.scale[:] *= 0.2
    view = View(AHEAD, 48, 32, 40.0)
    shown = picture(splats, view)
    difference = np.abs(shown.astype(int) - slow_picture(splats, view).astype(int))
    assert difference.max() <= 2
    monkeypatch.setattr(render, "_PAIRS", 500)
    assert np.abs(picture(splats, view).astype(int) - shown.astype(int)).max() <= 1


def test_sizes_are_limited() -> None:
    with pytest.raises(ValueError, match="1 to 8192 pixels"):
        picture(some(1), View(AHEAD, 100_000, 10, 40.0))


PAGE = Path(__file__).resolve().parents[3] / "skills" / "irsim-runner" / "bridges" / "splats.md"


def test_all_commands_work_one_after_the_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_ply(tmp_path / "room.ply", room(spacing=0.12, axes=axes_of("colmap"), shift=(0, 1.2, 0)).columns)
    text = PAGE.read_text(encoding="utf-8")
    commands = [line for block in re.findall(r"```bash\n(.*?)```", text, re.DOTALL) for line in block.splitlines()]
    assert len(commands) == 9
    for command in commands:
        words = shlex.split(command, comments=True)[1:]
        if words[1] == "import":
            words += ["--resolution", "0.1"]
        if words[1] == "preview" and "width=320" not in words:
            words += ["--set", "width=60", "--set", "rows=40"]
        done = CliRunner().invoke(app, words)
        assert done.exit_code == 0, f"{command}\n{done.output}"
    written = {path.name for path in tmp_path.iterdir()}
    assert {"room.html", "room.png", "cameras", "dataset", "poses.jsonl", "run.gif", "step.png"} <= written


def test_all_frames_are_named() -> None:
    [listed] = re.findall(r"The frames are ([\w, ]+)\.", PAGE.read_text(encoding="utf-8"))
    assert set(re.split(r", | and ", listed)) == set(FRAMES)


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
