"""Every plot key of the scenario language does something."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from irsim.graphics.figure.figure import SceneFigure
from irsim.graphics.scene.scene import Circle, Line, Mark, Region, Scene, Sector, Stroke
from irsim.graphics.scene.style import STYLE_KEYS, Palette
from irsim.scenario.model.plot import ObjectPlot
from tests.env.driving import Make, take_steps
from tests.rendering.conftest import Picture

EVERYTHING = """
world: {plot: {figure_pixels: [400, 400], show_title: false, no_axis: true}}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.5}
  state: [3, 3, 0.4]
  goal: [8, 7, 0]
  behavior: {name: dash}
  fov: 1.5
  fov_radius: 3
  sensors: [{name: lidar2d, number: 20, range_max: 2}]
  plot: {show_goal: true, show_goal_text: true, show_text: true, show_trajectory: true, show_trail: true,
         show_fov: true, obj_alpha: 0.8}
"""

OTHER_VALUES = {
    **{f"{part}_color": "red" for part in ("obj", "goal", "text", "arrow", "traj", "trail", "fov")},
    **dict.fromkeys(("trail_edgecolor", "fov_edge_color"), "red"),
    **{f"{part}_alpha": 0.1 for part in ("goal", "traj", "trail", "fov")},
    **{f"{part}_alpha": 0.3 for part in ("obj", "text", "arrow")},
    **{f"{part}_zorder": 8 for part in ("goal", "traj", "trail", "fov")},
    **{f"{part}_zorder": -1 for part in ("obj", "text", "arrow")},
    **{
        f"show_{part}": False for part in ("goal", "goal_text", "text", "arrow", "trajectory", "trail", "sensor", "fov")
    },
    "obj_linestyle": ":",
    "obj_linewidth": 8.0,
    "text_size": 20,
    "text_position": [0.0, 0.0],
    "arrow_length": 2.0,
    "arrow_width": 2.0,
    "traj_style": ":",
    "traj_width": 0.1,
    "keep_traj_length": 3,
    "trail_freq": 5,
    "trail_type": "rectangle",
    "trail_linewidth": 5,
    "trail_fill": True,
    "keep_trail_length": 1,
}
NEEDS = {
    "trail_color": {"trail_fill": True},
    "goal_zorder": {"fov_zorder": 5},
    "text_zorder": {"text_position": [0.0, 0.0]},
    "obj_linestyle": {"obj_linewidth": 6.0},
}


def test_cycled_colors_begin_with_the_first_and_start_again() -> None:
    palette = Palette(cycle=["red", "green", "blue"])
    assert [palette.cycle_color(index) for index in range(4)] == ["red", "green", "blue", "red"]


def test_drawing_knows_the_keys_of_the_language() -> None:
    assert set(ObjectPlot.model_fields) == STYLE_KEYS
    assert set(OTHER_VALUES) == STYLE_KEYS - {"show_goals"}


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Any:
    import irsim

    path = tmp_path_factory.mktemp("style") / "everything.yaml"
    path.write_text(EVERYTHING)
    env = irsim.make(str(path), display=False, log_level="ERROR", seed=1)
    take_steps(env, 38)
    return env


@pytest.mark.parametrize("key", sorted(OTHER_VALUES))
def test_each_key_changes_the_picture(driven: Any, picture: Picture, key: str) -> None:
    needed = NEEDS.get(key, {})
    driven._env_plot.update("all", **needed)
    before = picture(driven)
    driven._env_plot.update("all", **needed, **{key: OTHER_VALUES[key]})
    after = picture(driven)
    assert (before != after).any(axis=2).sum() > 5


def test_overrides_hold_for_one_frame(driven: Any, picture: Picture) -> None:
    driven.render()
    before = picture(driven)
    driven.render(obj_color="red", mode="all")
    assert (picture(driven) != before).any()
    driven.render()
    assert (picture(driven) == before).all()


def test_a_misspelt_option_is_reported_once(make: Make, capsys: pytest.CaptureFixture[str]) -> None:
    env = make(EVERYTHING, log_level="WARNING")
    capsys.readouterr()
    env.render(show_gaol=False)
    env.render(show_gaol=False)
    out = capsys.readouterr().out
    assert out.count("show_gaol") == 1
    assert "did you mean 'show_goal'" in out


def test_an_unknown_mode_is_refused(make: Make) -> None:
    with pytest.raises(ValueError, match="dynamic, static, all"):
        make(EVERYTHING).render(mode="everything")


@pytest.mark.parametrize("shape", ["sector", "line", "region", "circle"])
def test_dashes_far_outside_the_view_are_not_made(shape: str) -> None:
    far = 1e9
    ring = np.array([(2.0, 2.0), (far, 2.0), (far, far), (2.0, far)])
    geometry = {
        "sector": Sector(2.0, 2.0, far, 0.0, math.pi / 2),
        "line": Line(ring[:3]),
        "region": Region([ring]),
        "circle": Circle(2.0 - far, 5.0, far),
    }[shape]
    fill = "yellow" if shape == "region" else None
    figure = SceneFigure((200, 200), 100, axis=False)
    mark = Mark(0, "fov", geometry, fill, Stroke("red", 2.0, style=":"), 1.0, 2.0)
    scene = Scene(0.0, "Running", (0.0, 10.0, 0.0, 10.0), None, [mark], [], [], [])
    figure.show(scene, None)
    pixels, _ = figure.pixels(tight=False)
    colors = np.asarray(pixels)[..., :3].astype(int)
    red = (colors[..., 0] > 200) & (colors[..., 1] < 100)
    assert 20 < red.sum() < 2000
    yellow = (colors[..., :2].min(axis=-1) > 200) & (colors[..., 2] < 50)
    assert (yellow.mean() > 0.2) == (fill is not None)
