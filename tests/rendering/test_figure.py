"""Pixels of the picture: what is where, in which colour."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from tests.env.driving import Make, take_steps
from tests.rendering.conftest import Look, Picture, colors_at

GREEN, BLACK, WHITE = (0, 158, 115), (0, 0, 0), (255, 255, 255)
MAX_ROUNDING_LEVELS = 3
"""Levels (of 256) by which sheets that are laid over one another may differ from a drawing in one go."""
PLAIN = """
robot: {kinematics: {name: omni}, shape: {name: circle, radius: 0.5}, state: [2, 3, 0], goal: [8, 3, 0],
        behavior: {name: dash}, plot: {show_goal: true}, name: anna}
obstacle: {state: [5, 7, 0], shape: {name: rectangle, length: 3, width: 1}}
"""


@pytest.fixture
def env(make: Make) -> Any:
    return make(PLAIN)


def test_things_are_drawn_where_they_are(env: Any, color_at: Look) -> None:
    assert (color_at(env, 2, 3), color_at(env, 5, 7), color_at(env, 6.4, 7)) == (GREEN, BLACK, BLACK)
    assert color_at(env, 5, 8) == WHITE
    faint = tuple(round((level + 255) / 2) for level in GREEN)
    assert color_at(env, 8, 3) == pytest.approx(faint, abs=1)


def test_a_picture_shows_the_state_it_is_made_at(env: Any, color_at: Look) -> None:
    env.render()
    take_steps(env, 30)
    x = float(env.robot.position[0, 0])
    assert x == pytest.approx(5.0)
    assert (color_at(env, x, 3), color_at(env, 2, 3)) == (GREEN, WHITE)


def test_a_metre_is_as_long_up_as_across(make: Make, picture: Picture) -> None:
    env = make("world: {width: 30, height: 10}\nobstacle: {state: [15, 5, 0], shape: {name: circle, radius: 3}}")
    whole = picture(env)
    box = env._env_plot.ax.bbox
    inside = whole[int(800 - box.y1) + 5 : int(800 - box.y0) - 5, int(box.x0) + 5 : int(box.x1) - 5]
    ink = (inside == 0).all(axis=2)
    rows, columns = np.flatnonzero(ink.any(axis=1)), np.flatnonzero(ink.any(axis=0))
    assert np.ptp(rows) == pytest.approx(np.ptp(columns), abs=1)
    assert np.ptp(rows) > 80


@pytest.mark.parametrize(
    ("plot", "size"),
    [
        ("figure_pixels: [640, 480], saved_figure: {bbox_inches: null}", (640, 480)),
        ("figure_pixels: [300, 500], saved_figure: {bbox_inches: null, dpi: 50}", (300, 500)),
    ],
)
def test_the_figure_has_the_size_asked_for(make: Make, plot: str, size: tuple[int, int]) -> None:
    env = make(f"world: {{plot: {{{plot}}}}}\n{PLAIN}")
    with Image.open(env.save_figure()) as image:
        assert (image.size, image.mode) == (size, "RGB")


def test_tight_pictures_have_no_empty_rim(make: Make) -> None:
    env = make(f"world: {{width: 10, height: 3, plot: {{saved_figure: {{pad_inches: 0}}}}}}\n{PLAIN}")
    pixels = np.asarray(env._env_plot.frame())
    ink = (pixels < 250).any(axis=2)
    assert pixels.shape[0] < 500
    assert all(rim.any() for rim in (ink[:4], ink[-4:], ink[:, :4], ink[:, -4:]))


def test_axes_and_title_can_be_left_out(make: Make, picture: Picture) -> None:
    bare = picture(make(f"world: {{plot: {{no_axis: true, show_title: false}}}}\n{PLAIN}"))
    assert (bare[:, :130].min(), bare[:20].min()) == (255, 255)
    titled = picture(make(f"world: {{plot: {{no_axis: true}}}}\n{PLAIN}"))
    assert titled[:40].min() < 100


def test_titles_are_time_and_status_or_what_the_user_says(env: Any, make: Make) -> None:
    def title(env: Any) -> str:
        env._env_plot.frame()
        return env._env_plot.ax.get_title()

    take_steps(env, 3)
    assert title(env) == "Simulation Time: 0.30s, Status: Running"
    env.set_title("Lap 3")
    assert title(env) == "Lap 3"
    env.reset()
    assert title(env) == "Simulation Time: 0.00s, Status: Reset"
    assert title(make(f"world: {{plot: {{title: Office}}}}\n{PLAIN}")) == "Office"


def test_a_title_too_long_for_the_figure_is_written_smaller(make: Make) -> None:
    env = make(f"world: {{plot: {{figure_pixels: [400, 400], title: '{'long ' * 12}'}}}}\n{PLAIN}")
    plot = env._env_plot
    plot.frame()
    box = plot.ax.title.get_window_extent(plot.fig.canvas.get_renderer())
    assert box.x0 >= 0
    assert box.x1 <= 400


@pytest.mark.parametrize("text", ["$x^2$", r"\frac{", "$", "a_b $\\nosuchcommand$", "tab\tand\nline"])
def test_texts_of_users_are_text(make: Make, picture: Picture, text: str) -> None:
    env = make(PLAIN + "\ngui: {}")
    env.robot.set_text(text)
    env.set_title(text)
    env.render(show_text=True)
    assert picture(env).min() == 0


def test_labels_at_the_edge_are_not_cut(make: Make) -> None:
    env = make("""
obstacle:
  number: 4
  state: [[0.1, 0.1, 0], [9.9, 9.9, 0], [0.1, 9.9, 0], [9.9, 0.1, 0]]
  shape: {name: circle, radius: 0.3}
  plot: {show_text: true}
""")
    for view in env.objects:
        view.set_text("a rather long name")
    plot = env._env_plot
    plot.frame()
    renderer = plot.fig.canvas.get_renderer()
    boxes = [text.get_window_extent(renderer) for text in plot.ax.texts]
    assert len(boxes) == 4
    for box in boxes:
        assert plot.ax.bbox.x0 <= box.x0 <= box.x1 <= plot.ax.bbox.x1
        assert plot.ax.bbox.y0 <= box.y0 <= box.y1 <= plot.ax.bbox.y1


def test_labels_of_what_is_out_of_view_are_left_out(make: Make) -> None:
    env = make(f"world: {{plot: {{viewpoint: [100, 100]}}}}\n{PLAIN}")
    env.render(mode="all", show_text=True)
    whole = np.asarray(env._env_plot.frame())
    assert not [text for text in env._env_plot.ax.texts if text.get_visible()]
    assert whole.shape[1] < 900


def test_the_view_follows_an_object_from_the_first_frame(make: Make, picture: Picture) -> None:
    env = make(f"world: {{plot: {{viewpoint: anna}}}}\n{PLAIN}")
    for _ in range(2):
        shot = picture(env)
        ax = env._env_plot.ax
        column, row = ax.transData.transform(env.robot.position[:, 0])
        assert tuple(shot[shot.shape[0] - 1 - int(row), int(column)]) == GREEN
        assert (column, row) == pytest.approx(((ax.bbox.x0 + ax.bbox.x1) / 2, (ax.bbox.y0 + ax.bbox.y1) / 2), abs=1)
        assert np.diff(ax.get_xlim()) == pytest.approx(10)
        take_steps(env, 20)


def test_the_view_keeps_to_a_point(make: Make) -> None:
    plot = make(f"world: {{plot: {{viewpoint: [1, 2]}}}}\n{PLAIN}")._env_plot
    plot.frame()
    assert (plot.ax.get_xlim(), plot.ax.get_ylim()) == ((-4, 6), (-3, 7))


def test_trajectories_are_as_wide_as_said(env: Any, picture: Picture) -> None:
    take_steps(env, 40)
    env.render(show_trajectory=True, traj_width=1.0, traj_alpha=1.0, traj_color="#123456", show_goal=False)
    shot = picture(env)
    ax = env._env_plot.ax
    column, row = ax.transData.transform((4, 3))
    stripe = (shot[:, int(column)] == (0x12, 0x34, 0x56)).all(axis=1)
    metre = ax.transData.transform((0, 1))[1] - ax.transData.transform((0, 0))[1]
    assert stripe.sum() == pytest.approx(metre, abs=2)
    assert stripe[shot.shape[0] - 1 - int(row)]


def test_frames_equal_a_drawing_from_scratch(make: Make) -> None:
    env = make("""
robot:
  - number: 3
    kinematics: {name: diff}
    distribution: {name: circle, radius: 4}
    behavior: {name: dash}
    color: cycle
    sensors: [{name: lidar2d, number: 30, range_max: 3}]
    plot: {show_text: true, show_goal: true, show_goal_text: true, show_trajectory: true, show_trail: true,
           show_fov: true, trail_freq: 4}
  - {kinematics: {name: acker}, state: [2, 2, 1], shape: {name: rectangle, length: 2, width: 1, wheelbase: 1.2}}
obstacle:
  - {number: 5, distribution: {name: random}, shape: {name: circle, radius: 0.3}, plot: {obj_alpha: 0.5}}
  - {state: [0, 0, 0], shape: {name: linestring, vertices: [[1, 1], [3, 9], [6, 6]]}, plot: {obj_linestyle: "--"}}
""")
    plot = env._env_plot
    for step in range(6):
        env.draw_points([[1, step]])
        env.render()
        take_steps(env, 3)
        plot.frame()
        quick = np.asarray(plot.fig.canvas.buffer_rgba()).astype(int)
        FigureCanvasAgg.draw(plot.fig.canvas)
        slow = np.asarray(plot.fig.canvas.buffer_rgba()).astype(int)
        assert np.abs(quick - slow).max() <= MAX_ROUNDING_LEVELS


def test_drawings_of_scripts_stay_or_last_one_frame(env: Any, color_at: Look) -> None:
    env.draw_points(np.array([[1.0, 2.0], [1.0, 1.0]]), s=200, c="red")
    env.draw_box(np.array([[6, 8, 8, 6], [8, 8, 9, 9.0]]), color="-b")
    env.draw_trajectory([np.array([[1.0], [5.0]]), np.array([[3.0], [5.0]])], "r-", linewidth=6, show_direction=False)
    env.draw_quiver((4, 1, 2, 0), color="m", width=0.02, scale=10)
    env.render()
    assert color_at(env, 1, 1) == color_at(env, 2, 1) == (255, 0, 0)
    assert color_at(env, 2, 5) == (255, 0, 0)
    assert [0, 0, 255] in colors_at(env, [(7, 8 + d) for d in np.linspace(-0.05, 0.05, 11)]).tolist()
    assert color_at(env, 4, 1) == (191, 0, 191)
    env.render()
    assert (color_at(env, 1, 1), color_at(env, 2, 5)) == (WHITE, (255, 0, 0))
    env.reset()
    assert color_at(env, 2, 5) == WHITE


def test_what_scripts_put_on_the_axes_is_in_the_frame(env: Any, color_at: Look) -> None:
    env._env_plot.ax.plot([1, 9], [9, 9], color="#ff00ff", linewidth=8)
    assert color_at(env, 4, 9) == (255, 0, 255)
    env._env_plot.ax.set_xlim(0, 20)
    assert color_at(env, 2, 3) == GREEN


def test_beams_can_have_colours_of_their_own(make: Make) -> None:
    env = make(
        "robot: {kinematics: {name: omni}, state: [2, 5, 0], sensors: [{name: lidar2d, number: 3, range_max: 5}],"
        " shape: {name: circle, radius: 0.1}}"
    )
    near = [(4, 5 + d) for d in np.linspace(-0.03, 0.03, 7)]
    assert (0, 0, 255) not in map(tuple, colors_at(env, near).tolist())
    env.robot.set_laser_color([1], "blue", alpha=1.0)
    seen = colors_at(env, near)
    assert (seen[:, 0].min() < 30, seen[:, 2].max()) == (True, 255)


def test_pictures_stand_for_bodies_and_turn_with_them(make: Make, color_at: Look, tmp_path: Path) -> None:
    half = Image.new("RGB", (40, 20), "red")
    half.paste("blue", (20, 0, 40, 20))
    half.save(tmp_path / "two.png")
    env = make(
        "robot: {kinematics: {name: omni}, state: [5, 5, 1.5707963], shape: {name: rectangle, length: 4, width: 2},"
        " description: two.png}"
    )
    assert (color_at(env, 5, 6.5), color_at(env, 5, 3.5)) == ((0, 0, 255), (255, 0, 0))
    assert color_at(env, 6.5, 5) == WHITE


def test_cars_have_a_bundled_picture(make: Make, picture: Picture) -> None:
    env = make(
        "robot: {kinematics: {name: acker}, state: [4, 5, 0, 0],"
        " shape: {name: rectangle, length: 4, width: 2, wheelbase: 2}, plot: {show_arrow: false}}"
    )
    assert len(np.unique(picture(env) @ [1, 256, 65536])) > 300, "many colours"


@pytest.mark.parametrize(
    ("file", "says"),
    [("nosuch.png", "'nosuch.png' not found"), ("scenario.yaml", "'scenario.yaml' cannot be read as an image")],
)
def test_a_picture_that_cannot_be_read_is_reported_once_and_the_shape_drawn(
    make: Make, color_at: Look, capsys: pytest.CaptureFixture[str], file: str, says: str
) -> None:
    env = make(PLAIN.replace("name: anna", f"description: {file}"), log_level="WARNING")
    assert [color_at(env, 2, 3) for _ in range(2)] == [GREEN, GREEN]
    assert capsys.readouterr().out.count(says) == 1


def test_layers_cover_each_other_in_order(make: Make, color_at: Look) -> None:
    env = make("""
robot: {kinematics: {name: omni}, state: [5, 5, 0], shape: {name: circle, radius: 1}}
obstacle: {state: [5, 5, 0], shape: {name: rectangle, length: 6, width: 1}, color: red, unobstructed: true}
""")
    assert color_at(env, 5, 5) == GREEN
    env.render(mode="static", obj_zorder=7)
    assert color_at(env, 5, 5) == (255, 0, 0)


def test_a_colour_that_is_none_says_so(env: Any) -> None:
    env.render(obj_color="greenish")
    with pytest.raises(ValueError, match="greenish"):
        env.save_figure()


@pytest.mark.parametrize(
    ("keys", "want"),
    [
        ("", (0, 158, 115)),
        ("color: red", (255, 0, 0)),
        pytest.param("plot: {obj_color: '#0000ff'}", (0, 0, 255), marks=pytest.mark.slow),
        pytest.param("color: red, description: car_blue.png", (0, 114, 178), marks=pytest.mark.slow),
    ],
)
def test_cars_have_the_color_that_was_asked_for(make: Make, keys: str, want: tuple[int, ...]) -> None:
    car = "kinematics: {name: acker, wheelbase: 2}, shape: {name: rectangle, length: 4, width: 2}, state: [5, 5, 0, 0]"
    env = make(f"robot: {{{car}, {keys}}}")
    env.render(show_arrow=False)
    near = colors_at(env, [(x, y) for x in np.linspace(4, 7.5, 30) for y in (4.9, 5.4, 5.6)])
    assert np.abs(near.astype(int) - want).sum(axis=1).min() < 40
