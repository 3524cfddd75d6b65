"""Every plot key of the scenario language does something."""

from __future__ import annotations

from typing import Any

import pytest

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
    "obj_color": "red",
    "obj_alpha": 0.3,
    "obj_linestyle": ":",
    "obj_linewidth": 8.0,
    "obj_zorder": -1,
    "show_goal": False,
    "goal_color": "red",
    "goal_alpha": 0.1,
    "goal_zorder": 9,
    "show_goal_text": False,
    "show_text": False,
    "text_color": "red",
    "text_size": 20,
    "text_alpha": 0.3,
    "text_zorder": 0,
    "text_position": [0.0, 0.0],
    "show_arrow": False,
    "arrow_color": "red",
    "arrow_length": 2.0,
    "arrow_width": 2.0,
    "arrow_alpha": 0.2,
    "arrow_zorder": 0,
    "show_trajectory": False,
    "traj_color": "red",
    "traj_style": ":",
    "traj_width": 0.1,
    "traj_alpha": 0.1,
    "traj_zorder": 8,
    "keep_traj_length": 3,
    "show_trail": False,
    "trail_freq": 5,
    "trail_type": "rectangle",
    "trail_edgecolor": "red",
    "trail_linewidth": 5,
    "trail_alpha": 0.1,
    "trail_fill": True,
    "trail_color": "red",
    "trail_zorder": 8,
    "keep_trail_length": 1,
    "show_sensor": False,
    "show_fov": False,
    "fov_color": "red",
    "fov_edge_color": "red",
    "fov_alpha": 0.1,
    "fov_zorder": 8,
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
