"""Contacts within a step are marked in snapshots and strips, from the moment on at which they happen."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import irsim
from irsim.api import snapshot
from irsim.diagnostics.errors import PolicyError
from irsim.policies.catalog import UnknownPolicyError
from tests.episodes.test_between_steps import scene

PLACE = [7.4, 2.4, 8.7, 3.6]
"""Part of the world round the place where a robot passes through a board, in steps 20 to 30."""
RED = np.array([0xCC, 0x33, 0x11])
LONE = """\
world: {width: 8, height: 4, step_time: 0.1}
robot:
  - {name: rover, kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [1, 2], goal: [7, 2]}
"""


def red_pixels(text: str, steps: int, **options: Any) -> np.ndarray:
    """Which pixels of a picture of the place have the colour of the marks."""
    png = snapshot(text=text, steps=steps, region=PLACE, size=600, **{"overlays": ["names"], **options}).png
    pixels = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), dtype=int)
    return np.abs(pixels - RED).max(axis=2) < 70


# contacts within a step
@pytest.mark.parametrize("options", [{"overlays": None}, {}, {"strip": 2}], ids=["all overlays", "names", "strip"])
def test_a_picture_marks_the_place_after_the_passage(options: dict[str, Any]) -> None:
    assert red_pixels(scene(), 20, **options).sum() == 0
    assert red_pixels(scene(), 30, **options).sum() > 10


def test_what_others_pass_through_has_no_mark() -> None:
    text = scene(post=", unobstructed: true", board=", unobstructed: true")
    assert red_pixels(text, 30).sum() == 0


@pytest.mark.parametrize(("steps", "explained"), [(20, False), (30, True)])
def test_a_strip_says_what_the_marks_mean(steps: int, explained: bool) -> None:
    red = red_pixels(scene(), steps, strip=2, style="classic")
    captions = red[len(red) // 2 :][:20]  # of the second of two tiles, one above the other
    assert captions.any() == explained


# under another policy
@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "scene.yaml"
    path.write_text(LONE)
    return path


def test_a_strip_shows_the_episode_of_the_policy(file: Path, tmp_path: Path) -> None:
    still = irsim.render(file, tmp_path / "still.png", strip=2)
    driven = irsim.render(file, tmp_path / "driven.png", strip=2, policy="orca")
    assert driven.steps < 100 < still.steps  # the first one has no policy, so its robot stands
    assert "--policy orca" in driven.reproduce
    assert "--policy" not in still.reproduce


def test_pictures_and_animations_show_it_too(file: Path, tmp_path: Path) -> None:
    def ahead(seen):
        return [[1.0, 0.0]] * len(seen)

    moved = irsim.render(file, tmp_path / "a.png", steps=20, policy=ahead)
    still = irsim.render(file, tmp_path / "b.png", steps=20)
    assert (tmp_path / "a.png").read_bytes() != (tmp_path / "b.png").read_bytes()
    assert moved.steps == still.steps == 20
    shown = irsim.render(file, tmp_path / "c.gif", policy="dash")
    assert 55 < shown.steps < 65
    assert shown.frames > 50


@pytest.mark.parametrize(
    ("policy", "error", "says"),
    [("goal_lidar", PolicyError, "policy-mismatch"), ("orka", UnknownPolicyError, "did you mean orca")],
)
def test_a_policy_that_cannot_drive_them_is_refused_and_nothing_is_written(
    file: Path, tmp_path: Path, policy: str, error: type[Exception], says: str
) -> None:
    with pytest.raises(error, match=says):
        irsim.render(file, tmp_path / "a.png", policy=policy)
    assert not (tmp_path / "a.png").exists()


"""Part of the world round the place where a robot passes through a board."""
