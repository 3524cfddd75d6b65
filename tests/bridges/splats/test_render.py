"""Pictures of splats: one by hand, and many against a loop over pixels."""

from __future__ import annotations

import numpy as np
import pytest

from irsim.bridges.frames import camera_pose
from irsim.bridges.splats import render
from irsim.bridges.splats.render import View, picture
from irsim.bridges.splats.splats import Splats, covariance_of, join_splats
from tests.bridges.splats.test_splats import some

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
