"""The style `modern`: what a reader sees of robots, people, goals, contacts and outcomes."""

from __future__ import annotations

import itertools
import re
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence

import irsim
from irsim.bundled import templates
from irsim.graphics.figure import dashes
from irsim.graphics.figure.figure import SceneFigure
from irsim.graphics.figure.measuring import TextSizes
from irsim.graphics.scene.bodies import bounds
from irsim.graphics.scene.scene import Circle, Fog, Scene
from irsim.graphics.scene.theme import DARK, LIGHT, THEMES
from irsim.options.colors import rgb
from irsim.rendering.modern.layout import NORMAL, PRINT, SMALL
from irsim.rendering.modern.names import _text_box
from tests.graphics.test_theme import lab
from tests.rendering.modern.conftest import (
    Opened,
    labels_of,
    marks_of,
    parts_of,
    picture_of,
    pixels_of,
    take,
    title_of,
    words_of,
)

SIX = ("crossing", "warehouse", "crowd", "doorway", "cave", "fmcw-watch")
TITLE = re.compile(r"^.* \d+\.\d s (start|running|arrived|timeout|stopped|(\d+ )?collided)$")
ALONE = """
world: {{width: 6, height: 5, step_time: 0.1}}
robot:
  kinematics: {{name: diff}}
  shape: {{name: circle, radius: 0.4}}
  state: [2, 2, {heading}]
  goal: [5, 4, 0]
  behavior: {{name: dash}}
  color: "#0072B2"
"""
WALL = """
world: {width: 8, height: 4, step_time: 0.1}
robot:
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 2, 0], goal: [7, 2, 0],
     behavior: {name: dash}, name: rammer}
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 3.4, 0], goal: [1.6, 3.4, 0],
     behavior: {name: dash}, name: quick}
obstacle: [{shape: {name: rectangle, length: 0.4, width: 2}, state: [4, 2, 0]}]
"""

CROWDED = """
world: {width: 40, height: 40, step_time: 0.1}
robot:
  number: NUMBER
  distribution: {name: circle, radius: 15, center: [20, 20]}
  kinematics: {name: omni}
  shape: {name: circle, radius: 0.3}
  behavior: {name: orca}
"""


@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize("name", SIX)
def test_texts_cover_neither_each_other_nor_what_moves(opened: Opened, name: str, theme: str) -> None:
    env, sizes = opened(name, theme), TextSizes()
    for steps in (0, 60, 60):
        take(env, steps)
        for side, printed in ((900.0, False), (480.0, False), (302.0, True)):
            scene, layout = picture_of(env, side, printed=printed)
            boxes = [_text_box(label, layout, sizes) for label in scene.labels]
            for one, other in itertools.combinations(boxes, 2):
                assert not overlap(one, other)
            for left, bottom, right, top in boxes:
                assert left >= 0, name
                assert right <= layout.width, name
                assert bottom >= 0, name
                assert top <= layout.height, name
            moving = [m for m in scene.all_marks() if m.part in ("head", "badge", "goal", "dart", "contact")]
            for mark, label in itertools.product(moving, labels_of(scene, "name") + labels_of(scene, "moment")):
                x0, y0, x1, y1 = bounds(mark.geometry)
                (x0, y0), (x1, y1) = layout.places(np.array([(x0, y0), (x1, y1)])).tolist()
                assert not overlap((x0, y0, x1, y1), _text_box(label, layout, sizes)), (label.text, mark.part)
    env.end(ending_time=0.0)


def overlap(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    slack = 0.01
    return all(one[k] < other[k + 2] - slack and other[k] < one[k + 2] - slack for k in (0, 1))


@pytest.mark.parametrize("name", SIX)
def test_the_title_says_time_and_outcome(opened: Opened, name: str) -> None:
    env = opened(name)
    scene, _ = picture_of(env)
    assert title_of(scene) == f"{name} 0.0 s start"
    take(env, 40)
    scene, _ = picture_of(env)
    assert TITLE.match(title_of(scene))
    assert not any("None" in label.text or "Status" in label.text for label in scene.labels)


@pytest.mark.slow
@pytest.mark.parametrize("name", templates.names())
def test_every_template_has_a_title_at_its_end(opened: Opened, name: str) -> None:
    env = opened(name)
    for _ in range(3):
        scene, _ = picture_of(env, 900)
        assert TITLE.match(title_of(scene)), name
        take(env, 100)
    env.end(ending_time=0.0)


def test_a_robot_that_touched_something_has_not_just_arrived(opened: Opened) -> None:
    env = opened(WALL)
    take(env, 60)
    scene, layout = picture_of(env)
    assert words_of(scene)["outcome"] == "1 collided"
    assert words_of(scene)["facts"].startswith("1 of 2 arrived")
    [time] = labels_of(scene, "moment")
    [star] = [m for m in marks_of(scene, "contact") if m.fill == LIGHT.danger]
    event = next(event for event in env.events if event.kind == "collision")
    assert time.text == f"{event.time:.1f} s"
    x0, y0, x1, y1 = bounds(star.geometry)
    assert ((x0 + x1) / 2, (y0 + y1) / 2) == pytest.approx((event.x, event.y), abs=layout.metres(0.5))


def test_states_differ_by_shape(opened: Opened) -> None:
    env = opened(WALL)
    before, _ = picture_of(env)
    take(env, 60)
    after, _ = picture_of(env)
    rammer, quick = (view.id for view in env.robot_list)
    assert "badge" not in parts_of(before, quick)
    assert {"badge", "sign"} <= set(parts_of(after, quick))
    assert "ring" in parts_of(after, rammer)
    assert "ring" not in parts_of(after, quick)
    assert not [mark for mark in marks_of(after, "goal") if mark.object == quick], "the goal goes with the arrival"


@pytest.mark.parametrize("heading", np.linspace(0, 2 * np.pi, 8, endpoint=False).round(4).tolist())
def test_the_dart_points_where_the_robot_heads(opened: Opened, heading: float) -> None:
    env = opened(ALONE.format(heading=heading))
    pixels, layout = pixels_of(env, 480)
    [[x, y]] = layout.places(np.array([(2.0, 2.0)])).tolist()
    column, row, reach = x, layout.height - y, 0.9 * 0.4 * layout.scale
    rows, columns = np.mgrid[: pixels.shape[0], : pixels.shape[1]]
    inside = np.hypot(columns + 0.5 - column, rows + 0.5 - row) < reach
    bright = inside & (pixels.astype(int).min(axis=2) > 200)
    assert bright.sum() > 20
    middle = columns[bright].mean() + 0.5 - column, row - (rows[bright].mean() + 0.5)
    ahead = middle[0] * np.cos(heading) + middle[1] * np.sin(heading)
    assert ahead > 0.02 * reach


def test_bodies_have_their_size_and_small_ones_are_seen(opened: Opened) -> None:
    env = opened(ALONE.format(heading=0))
    scene, _ = picture_of(env, 480)
    [body] = [m for m in marks_of(scene, "body") if m.object == 0]
    assert isinstance(body.geometry, Circle)
    assert body.geometry.radius == 0.4
    far = opened(ALONE.format(heading=0).replace("width: 6, height: 5", "width: 120, height: 100"))
    scene, layout = picture_of(far, 480)
    [body] = [m for m in marks_of(scene, "body") if m.object == 0]
    assert bounds(body.geometry)[2] - bounds(body.geometry)[0] >= layout.metres(2 * 5.5) - 1e-9
    for sizes in (NORMAL, SMALL, PRINT):
        assert min(sizes.title, sizes.facts, sizes.name, sizes.foot_text) >= (9.4 if sizes is PRINT else 9)


def test_a_body_has_its_size_in_pixels(opened: Opened) -> None:
    pixels, layout = pixels_of(opened(ALONE.format(heading=0)), 480)
    [[x, y]] = layout.places(np.array([(2.0, 2.0)])).tolist()
    row, paper = pixels[int(layout.height - y)].astype(int), np.array(rgb(LIGHT.paper)) * 255
    inside = np.flatnonzero(np.abs(row - paper).max(axis=1)[int(x) - 60 : int(x) + 60] > 60) + int(x) - 60
    edge = 1.4 / 2
    assert inside[0] == pytest.approx(x - 0.4 * layout.scale - edge, abs=1.0)
    across = x - 0.4 * layout.scale, x + 0.4 * layout.scale
    levels = np.abs(row - paper).max(axis=1)[: int(x)]
    fill = levels[int(across[0]) + 3]
    covered = levels[int(across[0]) - 4 : int(across[0]) + 3].clip(0, fill).sum() / fill
    assert int(across[0]) + 3 - covered == pytest.approx(across[0] - edge, abs=0.5)


def test_the_same_picture_at_another_resolution_differs_only_in_that(opened: Opened) -> None:
    env = opened("doorway")
    take(env, 30)
    images = [Image.fromarray(pixels_of(env, 400, ratio)[0]).convert("L") for ratio in (1.0, 3.125)]
    half = images[0].width // 2, images[0].height // 2
    one, other = (np.asarray(image.resize(half, Image.Resampling.BOX), float) for image in images)
    assert similarity(one, other) > 0.95


def test_pictures_of_high_resolution_are_the_same_at_full_size(opened: Opened) -> None:
    """At one pixel per unit, letters and lines along the axes lie on whole pixels, so this compares finer pictures."""
    env = opened("doorway")
    take(env, 30)
    images = [Image.fromarray(pixels_of(env, 400, ratio)[0]).convert("L") for ratio in (3.125, 6.25)]
    size = round(images[0].width / 3.125), round(images[0].height / 3.125)
    one, other = (np.asarray(image.resize(size, Image.Resampling.BOX), float) for image in images)
    assert similarity(one, other) > 0.98


def similarity(one: np.ndarray, other: np.ndarray) -> float:
    """Structural similarity (Wang and others, 2004) in windows of 7 x 7 pixels."""
    some, others = (np.lib.stride_tricks.sliding_window_view(image, (7, 7)) for image in (one, other))
    mean, mean_other = some.mean((2, 3)), others.mean((2, 3))
    together = (some * others).mean((2, 3)) - mean * mean_other
    flat, low = (0.01 * 255) ** 2, (0.03 * 255) ** 2
    level = (2 * mean * mean_other + flat) / (mean**2 + mean_other**2 + flat)
    return float((level * (2 * together + low) / (some.var((2, 3)) + others.var((2, 3)) + low)).mean())


def test_fog_ends_softly_over_a_third_of_a_cell() -> None:
    figure = SceneFigure((400, 200), 96, page="#ffffff")
    for free in (2, 3):
        explored = np.zeros((4, 2), dtype=bool)
        explored[:free] = True
        fog = Fog(explored, (0.0, 4.0, 0.0, 2.0), "#000000", 1.0, 1.0, soft=1 / 3)
        figure.show(Scene(0.0, "", (0.0, 4.0, 0.0, 2.0), None, [], [], [], [], fog), None)
        levels = np.asarray(figure.pixels(tight=False)[0])[50, :, 0].astype(int)
        edge = 100 * free
        assert (levels[: edge - 17] == 255).all()
        assert (levels[edge + 17 :] == 0).all()
        assert levels[edge - 17 : edge + 17] == pytest.approx(np.linspace(255, 0, 34), abs=6)


@pytest.mark.slow
def test_a_frame_of_two_hundred_robots_takes_less_than_150_ms(opened: Opened) -> None:
    env, times = opened(CROWDED.replace("NUMBER", "200")), []
    for _ in range(12):
        env.step()
        start = time.process_time()
        env._env_plot.frame()
        times.append(time.process_time() - start)
    assert min(times[2:]) < 0.15


@pytest.mark.slow
@pytest.mark.parametrize("name", SIX)
def test_a_frame_takes_hardly_longer_than_a_classic_one(opened: Opened, name: str) -> None:
    plots = [opened(name), opened(name)]
    plots[1]._env_plot.set_style("classic")
    times: list[list[float]] = [[], []]
    for _ in range(30):
        for env, taken in zip(plots, times, strict=True):
            env.step()
            start = time.process_time()
            env._env_plot.frame()
            taken.append(time.process_time() - start)
    modern, classic = (min(taken[5:]) for taken in times)
    assert modern < 2 * classic


@pytest.mark.parametrize("name", ["crossing", "warehouse"])
def test_a_frame_is_the_picture_that_is_drawn_alone(opened: Opened, name: str) -> None:
    followed, alone = opened(name), opened(name)
    for _ in range(12):
        frame = np.asarray(followed._env_plot.frame())
        take(followed, 1)
    frame = np.asarray(followed._env_plot.frame())
    take(alone, 12)
    apart = np.abs(frame.astype(int) - np.asarray(alone._env_plot.frame()))
    assert apart.max() <= 2


def test_dashes_are_painted_as_matplotlib_draws_them(opened: Opened, monkeypatch: pytest.MonkeyPatch) -> None:
    env = opened("warehouse")
    painted, _ = pixels_of(env)
    monkeypatch.setattr(dashes, "MAX_DASHES", -1)
    drawn, _ = pixels_of(env)
    apart = np.abs(painted.astype(int) - drawn)
    assert apart.max() <= 24, "round ends of dashes may differ by some levels"
    assert apart.mean() < 0.05


@pytest.mark.parametrize("theme", THEMES)
def test_red_means_contact_and_nothing_else(opened: Opened, theme: str) -> None:
    env = opened(ALONE.format(heading=0).replace("#0072B2", "#009E73"), theme)
    take(env, 10)
    pixels, _ = pixels_of(env)
    danger = lab(THEMES[theme].danger, np.eye(3))
    colors = np.unique(pixels.reshape(-1, 3), axis=0)
    apart = [np.linalg.norm(lab("#{:02x}{:02x}{:02x}".format(*color), np.eye(3)) - danger) for color in colors.tolist()]
    assert min(apart) > 5


def test_robot_person_and_goal_differ_without_colours(opened: Opened) -> None:
    env = opened("crossing")
    take(env, 20)
    pixels, layout = pixels_of(env, 900)
    scene, _ = picture_of(env, 900)
    grey = np.asarray(Image.fromarray(pixels).convert("L"), dtype=float)
    robot = next(m for m in marks_of(scene, "body") if m.object == 0)
    goal = next(m for m in marks_of(scene, "goal") if m.object == 0)
    person = next(m for m in marks_of(scene, "halo") if m.object not in (0, 1, 2))
    looks = [histogram(grey, bounds(mark.geometry), layout) for mark in (robot, goal, person)]
    for one, other in itertools.combinations(looks, 2):
        assert np.abs(one - other).sum() > 0.4


def histogram(grey: np.ndarray, box: tuple[float, ...], layout: object) -> np.ndarray:
    (x0, y0), (x1, y1) = layout.places(np.array(box).reshape(2, 2)).tolist()  # type: ignore[attr-defined]
    rows = slice(int(grey.shape[0] - y1), int(grey.shape[0] - y0))
    counts, _ = np.histogram(grey[rows, int(x0) : int(x1)], bins=8, range=(0, 256))
    return np.asarray(counts / counts.sum())


def test_a_robot_that_cannot_drive_has_neither_goal_nor_plan(opened: Opened) -> None:
    env = opened("fmcw-watch")
    take(env, 5)
    scene, _ = picture_of(env)
    watcher = next(view.id for view in env.robot_list)
    assert not {"goal", "plan"} & set(parts_of(scene, watcher))
    assert {"body", "dart", "scan", "hit"} <= set(parts_of(scene, watcher))
    assert {label.text for label in labels_of(scene, "legend")} == {"goes away", "still", "comes nearer"}


def test_the_colours_of_the_table_are_exact_in_a_gif(tmp_path: Path) -> None:
    target = tmp_path / "run.gif"
    irsim.render(templates.scenario_file("crossing"), target, steps=3, size=400, seed=0, style="modern")
    with Image.open(target) as image:
        frame = np.asarray(next(iter(ImageSequence.Iterator(image))).convert("RGB"))
    colors = {tuple(color) for color in frame.reshape(-1, 3).tolist()}
    for name in ("page", "paper", "ink", "grid", "muted"):
        assert tuple(round(255 * level) for level in rgb(LIGHT.tokens[name])) in colors, name
    for color in ("#0072B2", "#009E73", "#D55E00"):
        assert tuple(round(255 * level) for level in rgb(LIGHT.shades("robot", color).fill)) in colors, color


def test_many_robots_lose_names_plans_and_goals_before_bodies(opened: Opened) -> None:
    seen = {}
    for number in (6, 20, 60):
        env = opened(CROWDED.replace("NUMBER", str(number)))
        take(env, 3)
        scene, _ = picture_of(env)
        counts = {part: len(marks_of(scene, part)) for part in ("dart", "plan", "goal")}
        seen[number] = counts["dart"], counts["plan"] > 0, counts["goal"] > 0, len(labels_of(scene, "name"))
        assert words_of(scene)["facts"] == f"{number} robots"
    assert seen == {6: (6, True, True, 6), 20: (20, False, True, 20), 60: (60, False, False, 0)}


def test_keys_of_the_scenario_win(opened: Opened) -> None:
    plot = "  plot: {show_goal: false, show_trajectory: false, show_text: false, show_arrow: false}\n"
    env = opened(ALONE.format(heading=0) + plot)
    take(env, 5)
    scene, _ = picture_of(env)
    assert not {"goal", "plan", "trajectory", "dart"} & {mark.part for mark in scene.all_marks()}
    assert labels_of(scene, "name") == []


def test_print_is_white_and_short(tmp_path: Path) -> None:
    target = tmp_path / "run.png"
    result = irsim.render(templates.scenario_file("doorway"), target, steps=5, seed=0, style="modern", printed=True)
    assert max(result.size) == 944
    with Image.open(target) as image:
        assert image.convert("RGB").getpixel((1, 1)) == (255, 255, 255)
    assert "--print" in result.reproduce


def test_text_stays_text_in_svg_and_the_file_is_the_same_again(tmp_path: Path) -> None:
    files = [tmp_path / name for name in ("one.svg", "two.svg")]
    for target in files:
        irsim.render(templates.scenario_file("doorway"), target, steps=5, seed=0, style="modern", theme="dark")
    one, two = (re.sub(r"<dc:date>.*?</dc:date>", "", target.read_text()) for target in files)
    assert ">robot_0</text>" in one
    assert one == two
    assert DARK.page in one


def test_an_unknown_style_or_theme_is_refused_with_what_there_is(tmp_path: Path) -> None:
    for words, what in (({"style": "moden"}, "modern"), ({"theme": "drak"}, "dark")):
        with pytest.raises(irsim.IrsimError, match=what):
            irsim.render(templates.scenario_file("doorway"), tmp_path / "x.png", **words)
