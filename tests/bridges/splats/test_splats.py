"""Splats as arrays, pictures of them, and what is written about them."""

from __future__ import annotations

import math
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from irsim.bridges.frames import FRAMES, axes_of, camera_pose
from irsim.bridges.splats import render
from irsim.bridges.splats.render import View, colors_seen, picture
from irsim.bridges.splats.splats import Splats, covariance_of, join_splats, moved, rotation_matrices, scale_of
from irsim.cli.app import app
from tests.bridges.splats.scenes import room, write_ply

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
