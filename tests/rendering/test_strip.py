"""Several moments as one picture."""

from __future__ import annotations

import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from irsim.api import snapshot
from irsim.api.film_strip import StripError, moments_of
from irsim.diagnostics.errors import OverLimitError
from irsim.graphics.scene.scene import Scene
from irsim.rendering import strip
from irsim.rendering.strip import tiling
from irsim.scenario.limits import Limits
from irsim.simulation.simulation import Simulation

SCENE = """\
world: {width: 8, height: 4, offset: [-1, 0]}
robot:
  - {name: rover, kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 2], goal: [5, 2],
     behavior: {name: dash}, color: red}
obstacle:
  - {name: crate, state: [6, 3], shape: {name: rectangle, length: 1, width: 0.5}}
"""
LONG = SCENE.replace("width: 8, height: 4", "width: 30, height: 3")


def pixels(png: bytes) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    with Image.open(io.BytesIO(png)) as image:
        assert image.mode == "P"
        return np.asarray(image.convert("RGB"))


def test_evenly_from_the_start_to_the_end() -> None:
    assert moments_of(50, 6) == [0, 10, 20, 30, 40, 50]
    assert moments_of(2, 6) == [0, 1, 2]
    for count in (1, 13):
        with pytest.raises(StripError, match="2 to 12"):
            moments_of(50, count)


@given(count=st.integers(2, 12), width=st.floats(5, 80), height=st.floats(5, 80), side=st.integers(200, 1024))
def test_tiles_fit(count: int, width: float, height: float, side: int) -> None:
    columns, (across, down) = tiling(count, width, height, side)
    rows = -(-count // columns)
    assert columns * (across + 6) + 6 <= side
    assert rows * (down + 17 + 6) + 6 <= side


def test_long_worlds_are_stacked() -> None:
    assert tiling(6, 30, 3, 600)[0] == 1
    assert tiling(4, 10, 10, 600)[0] == 2
    assert tiling(6, 3, 30, 600)[0] == 6


@pytest.mark.parametrize("text", [SCENE, LONG])
@pytest.mark.parametrize("size", [200, 600, 1024])
def test_whole_episode(text: str, size: int) -> None:
    result = snapshot(text=text, strip=4, size=size)
    assert result.moments[0] == 0
    assert result.moments[-1] == result.steps == 40
    assert result.robots[0].status == "arrived"
    assert 0.85 * size < max(result.size) <= size
    assert len(result.png) < 60_000


def test_the_robot_moves_from_tile_to_tile() -> None:
    image = pixels(snapshot(text=SCENE, strip=2, steps=20, size=600, overlays=[]).png).astype(int)
    assert len(image) < 620
    half = len(image) // 2
    red = (image[..., 0] > 200) & (image[..., 1] < 60) & (image[..., 2] < 60)
    places = [np.flatnonzero(part.any(axis=0)).mean() for part in (red[:half], red[half:])]
    assert places[1] - places[0] > 100


def test_up_to_a_step_and_always_the_same() -> None:
    result = snapshot(text=SCENE, strip=3, steps=10)
    assert result.moments == [0, 5, 10]
    assert "--step 10" in result.reproduce
    assert "--strip 3" in result.reproduce
    assert snapshot(text=SCENE, strip=3, steps=10).png == result.png
    without = snapshot(text=SCENE, strip=3, steps=10, draw=False)
    assert (without.png, without.robots) == (b"", result.robots)


def test_a_part_of_the_world() -> None:
    width, height = snapshot(text=SCENE, strip=2, steps=4, region=[0, 0, 6, 1]).size
    assert width > 1.5 * height


def test_limits_hold() -> None:
    with pytest.raises(OverLimitError):
        snapshot(text=SCENE, strip=3, steps=50, limits=Limits(steps=49))
    with pytest.raises(StripError):
        snapshot(text=SCENE, strip=13)


def test_the_first_tile_alone_names_obstacles(monkeypatch: pytest.MonkeyPatch) -> None:
    named = []

    def simplify(scene: Scene, simulation: Simulation, *, first: bool) -> None:
        original(scene, simulation, first=first)
        named.append(sorted(label.text for label in scene.labels if label.part == "name"))

    original = strip._simplify
    monkeypatch.setattr(strip, "_simplify", simplify)
    snapshot(text=SCENE, strip=2, steps=20, size=600, style="classic")
    assert named == [["crate", "rover"], ["rover"]]
