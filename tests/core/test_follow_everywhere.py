"""follow: every drive and footprint through mazes with every local behavior, touching nothing that stands still."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import irsim

DRIVES = {"diff": 2, "omni": 2, "omni_angular": 3, "acker": 2}
SHAPES = {
    "circle": "{name: circle, radius: 0.2%s}",
    "rectangle": "{name: rectangle, length: 0.6, width: 0.3%s}",
    "polygon": "{name: polygon, vertices: [[-0.2, -0.2], [0.3, 0], [-0.2, 0.2], [-0.1, 0]]}",
}
WALLS = """
  - {shape: {name: rectangle, length: 8, width: 0.2}, state: [4, 2.5, 0]}
  - {shape: {name: rectangle, length: 8, width: 0.2}, state: [6, 5, 0]}
  - {shape: {name: rectangle, length: 8, width: 0.2}, state: [4, 7.5, 0]}
  - {shape: {name: circle, radius: 0.4}, state: [5, 6.2, 0]}
  - {shape: {name: linestring, vertices: [[3, 2.6], [3, 3.6]]}, state: [0, 0, 0]}
"""


@pytest.fixture(scope="module")
def picture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The walls as a map: 0.1 m per pixel, the top row is y = 10 m."""
    free = np.full((100, 100), 255, dtype=np.uint8)
    for rows, columns in (((24, 26), (0, 80)), ((49, 51), (20, 100)), ((74, 76), (0, 80)), ((59, 65), (47, 53))):
        free[slice(*rows), slice(*columns)] = 0
    path = tmp_path_factory.mktemp("maze") / "maze.png"
    Image.fromarray(free[::-1]).save(path)
    return path


def maze(drive: str, shape: str, local: str, world: str, obstacles: str) -> str:
    kinematics = "{name: acker, wheelbase: 0.4}" if drive == "acker" else f"{{name: {drive}}}"
    text = SHAPES[shape]
    if "%s" in text:
        text %= ", wheelbase: 0.4" if drive == "acker" else ""
    limits = [1.0] * DRIVES[drive]
    return (
        f"world: {{width: 10, height: 10{world}}}\nrobot:\n"
        f"  - kinematics: {kinematics}\n    shape: {text}\n    state: [1, 1, 0]\n    goal: [9, 9, 0]\n"
        f"    vel_max: {limits}\n    vel_min: {[-v for v in limits]}\n"
        f"    behavior: {{name: follow, local: {local}}}\n{obstacles}"
    )


@pytest.mark.parametrize("local", ["dash", "rvo", "orca", "sfm"])
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("made_of", ["walls", "map", "boundary"])
def test_through_a_maze(made_of: str, drive: str, shape: str, local: str, picture: Path) -> None:
    obstacles = "" if made_of == "map" else f"obstacle:{WALLS}"
    world = {"walls": "", "map": f", obstacle_map: '{picture}'", "boundary": ", boundary: walls"}[made_of]
    result = irsim.run(text=maze(drive, shape, local, world, obstacles), seed=1, steps=700)
    assert result.outcome == "success", result.reason
    assert not [event for event in result.events if event.kind == "collision"]


def gap(x: float, y: float, width: float, thickness: float = 0.3) -> str:
    """A wall across the world at ``x`` with a gap about ``y``."""
    text = ""
    for low, high in ((0, y - width / 2), (y + width / 2, 10)):
        shape = f"{{name: rectangle, length: {thickness}, width: {high - low}}}"
        text += f"\n  - {{shape: {shape}, state: [{x}, {(low + high) / 2}, 0]}}"
    return text


def narrow(drive: str, shape: str, walls: str, local: str, top: list[float]) -> str:
    return (
        f"world: {{width: 10, height: 10, boundary: walls}}\nrobot:\n  - kinematics: {{name: {drive}}}\n"
        f"    shape: {shape}\n    state: [1, 1, 0]\n    goal: [9, 9, 0]\n    vel_max: {top}\n"
        f"    vel_min: {[-v for v in top]}\n    behavior: {{name: follow, local: {local}}}\nobstacle:{walls}\n"
    )


@pytest.mark.parametrize("local", ["dash", "rvo", "orca", "sfm"])
@pytest.mark.parametrize("drive", ["omni", "diff", "omni_angular"])
@pytest.mark.parametrize("walls", [gap(5, 5, 0.5), gap(4, 3, 0.6) + gap(6.5, 7, 0.6), gap(5, 5, 0.6, 4)])
def test_long_and_thin_through_gaps_without_room_to_turn(drive: str, local: str, walls: str) -> None:
    shape = "{name: rectangle, length: 1.4, width: 0.3}"
    result = irsim.run(text=narrow(drive, shape, walls, local, [1.0] * DRIVES[drive]), seed=1, steps=400)
    assert result.outcome == "success", result.reason
    assert not [event for event in result.events if event.kind == "collision"]


@pytest.mark.parametrize("local", ["dash", "rvo", "orca", "sfm"])
@pytest.mark.parametrize("steering", [1.0, 0.6, 0.4])
def test_a_car_through_gaps_with_its_turning_circle(steering: float, local: str) -> None:
    shape = "{name: rectangle, length: 0.8, width: 0.4, wheelbase: 0.5}"
    walls = gap(4, 3, 0.8) + gap(6.5, 7, 0.8)
    result = irsim.run(text=narrow("acker", shape, walls, local, [1.0, steering]), seed=1, steps=400)
    assert result.outcome == "success", result.reason
    assert not [event for event in result.events if event.kind == "collision"]


def test_too_narrow_is_said() -> None:
    shape = "{name: rectangle, length: 1.4, width: 0.3}"
    result = irsim.run(text=narrow("diff", shape, gap(5, 5, 0.28), "dash", [1.0, 1.0]), seed=1, steps=30)
    assert [event.kind for event in result.events] == ["no_path"]


def test_standing_before_a_way_that_is_too_narrow_is_said() -> None:
    """A disc as wide as the body gets round the corner between the walls, the body does not."""
    shape = "{name: rectangle, length: 1.4, width: 0.3}"
    walls = gap(4, 3, 0.5) + gap(4.8, 7, 0.5)
    result = irsim.run(text=narrow("diff", shape, walls, "dash", [1.0, 1.0]), seed=1, steps=250)
    assert result.outcome == "timeout"
    assert [event.kind for event in result.events] == ["no_path"]
    assert "no path" in str(result.reason)
