"""The page tells and shows of single robots: colour, speed, dart, name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import irsim
from tests.browser import Watched
from tests.runs.replay.browser.test_player import SHARE, pixel_of, scrub, settled, value
from tests.runs.replay.conftest import recorded, scene

pytestmark = pytest.mark.browser

PAIR = """\
world: {width: 12, height: 8, time_limit: 12}
robot:
  - {name: short, kinematics: {name: omni}, shape: {name: circle, radius: 0.5}, state: [2, 2, 0], goal: [4, 2, 0],
     behavior: {name: dash}}
  - {name: long, kinematics: {name: diff}, shape: {name: circle, radius: 0.5}, state: [2, 6, 0], goal: [9, 6, 0],
     behavior: {name: dash}}
"""
COUNT = """([x, y, w, h, color]) => {
    const copy = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
    const view = document.getElementById('view'), ratio = view.width / view.clientWidth;
    [copy.canvas.width, copy.canvas.height] = [view.width, view.height];
    copy.drawImage(view, 0, 0);
    const { data } = copy.getImageData(x * ratio, y * ratio, w * ratio, h * ratio);
    const parts = [1, 3, 5].map(at => parseInt(color.slice(at, at + 2), 16));
    let found = 0;
    for (let i = 0; i < data.length; i += 4) found += parts.every((part, k) => Math.abs(data[i + k] - part) < 24);
    return found;
}"""
"""Pixels of about a colour in a part of the view."""
BLUE_NAME = "#0072b2"


def arrival_of(page: Any, name: str) -> int:
    """The step at which a robot arrives, with the robot chosen."""
    page.select_option("#robot", label=name)
    page.locator("#events button.arrival", has_text=name).click()
    settled(page)
    return int(page.input_value("#time"))


def test_what_has_arrived_has_the_speed_with_which_it_moves(workspace: Path, watched: Watched) -> None:
    run = recorded(PAIR)
    page = watched.open(Path(irsim.replay(run).file))
    step = arrival_of(page, "short")
    assert value(page, "speed") == "0.00 m/s"
    assert value(page, "state") == "arrived"
    scrub(page, step - 1)
    assert value(page, "speed") == "1.00 m/s"
    assert value(page, "state") == "under way"
    scrub(page, step + 5)
    assert value(page, "speed") == "0.00 m/s"
    assert arrival_of(page, "long") == run.last_step
    assert value(page, "speed") == "1.00 m/s on arrival", "the run ends in the step in which it arrives"
    assert value(page, "state") == "arrived"


def test_what_is_stopped_by_a_collision_does_not_move(shown: Any, run: Any) -> None:
    shown.select_option("#robot", label="lorry")
    scrub(shown, run.last_step)
    assert value(shown, "state") == "in collision, stopped"
    assert value(shown, "speed") == "0.00 m/s"


def test_the_page_says_what_a_dart_means(workspace: Path, watched: Watched) -> None:
    page = watched.open(Path(irsim.replay(recorded(PAIR.replace("goal: [4, 2, 0]", "goal: [4, 4, 0]"))).file))
    page.select_option("#robot", label="short")
    scrub(page, 10)
    assert value(page, "dart") == "along its motion, 45°"
    assert value(page, "heading") == "0.00 rad (0°)"
    scrub(page, arrival_of(page, "short") + 5)
    assert value(page, "dart") == "heading, as it stands"
    page.select_option("#robot", label="long")
    settled(page)
    assert "dart" not in page.locator("#values dt").all_inner_texts(), "its dart is its heading, which is there"
    page.keyboard.press("?")
    assert "The dart in a robot points along its heading" in page.inner_text("#keys")


def test_robots_without_a_colour_are_told_apart(workspace: Path, watched: Watched) -> None:
    page = watched.open(Path(irsim.replay(recorded(PAIR)).file))
    settled(page)
    means = []
    for y in (2, 6):
        px, py = pixel_of(page, 2, y)
        means.append(page.evaluate(SHARE, [px - 3, py - 22, 6, 6]))
    assert means[0] == pytest.approx([0x00, 0x9E, 0x73], abs=4)
    assert means[1] == pytest.approx([0x00, 0x72, 0xB2], abs=4)


def test_the_name_of_a_picked_robot_stands_beside_it(workspace: Path, watched: Watched) -> None:
    page = watched.open(Path(irsim.replay(recorded(PAIR)).file))
    page.select_option("#robot", label="long")
    page.click("#trails")
    settled(page)
    x, y = pixel_of(page, 2, 6)
    ring = pixel_of(page, 2.5, 6)[0] - x + 6  # its outer edge
    assert page.evaluate(COUNT, [x - 25, y - ring - 25, 50, 22, BLUE_NAME]) == 0, "nothing above it"
    assert page.evaluate(COUNT, [x + ring + 1, y - 7, 40, 14, BLUE_NAME]) > 20
    assert page.evaluate(COUNT, [x + ring + 1, y - 7, 2, 14, BLUE_NAME]) == 0, "a gap"
    page.select_option("#robot", label="short")
    settled(page)
    assert page.evaluate(COUNT, [x - 25, y - ring - 25, 50, 25, BLUE_NAME]) > 20, "others are named above"


def test_a_name_without_room_on_the_right_stands_on_the_left(workspace: Path, watched: Watched) -> None:
    text = PAIR.replace("state: [2, 6, 0]", "state: [11.5, 6, 0]").replace("name: long", "name: a_robot_with_a_name")
    page = watched.open(Path(irsim.replay(recorded(text)).file))
    page.select_option("#robot", label="a_robot_with_a_name")
    settled(page)
    x, y = pixel_of(page, 11.5, 6)
    ring = pixel_of(page, 12, 6)[0] - x + 6
    assert page.evaluate(COUNT, [x - ring - 120, y - 7, 115, 14, BLUE_NAME]) > 60


def test_paper_is_light(workspace: Path, watched: Watched) -> None:
    page = watched.open(Path(irsim.replay(recorded(scene())).file))
    page.emulate_media(color_scheme="dark")
    settled(page)
    dark = page.evaluate(SHARE, [60, 60, 200, 200])
    page.emulate_media(color_scheme="dark", media="print")
    page.wait_for_timeout(200)
    light = page.evaluate(SHARE, [60, 60, 200, 200])
    assert max(dark) < 90 < 200 < min(light)
    page.emulate_media(color_scheme="dark", media="screen")
    settled(page)
    assert page.evaluate("document.documentElement.dataset.theme") == "dark"
