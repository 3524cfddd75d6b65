"""Late events and events within a step, on the page: objects that set off or appear later, contacts, passages."""

from __future__ import annotations

from pathlib import Path

import pytest

import irsim
from tests.browser import Watched
from tests.episodes.test_between_steps import scene as tunnel
from tests.runs.replay.browser.test_player import SHARE, pixel_of, scrub, settled, value
from tests.runs.replay.conftest import recorded

pytestmark = pytest.mark.browser

LATE = """\
world: {width: 12, height: 8, step_time: 0.1}
robot:
  - {name: early, kinematics: {name: omni}, shape: {name: circle, radius: 0.5}, state: [1, 1], goal: [11, 1],
     behavior: {name: dash}}
  - {name: waiting, kinematics: {name: omni}, shape: {name: circle, radius: 0.5}, state: [3, 4], goal: [11, 4],
     behavior: {name: dash}, start_time: 2, color: "#000000", plot: {show_arrow: false}}
obstacle:
  - {name: late, kinematics: {name: omni}, shape: {name: circle, radius: 0.5}, state: [6, 6.5], goal: [7, 6.5],
     behavior: {name: dash}, appear_time: 2, color: "#000000", plot: {show_arrow: false}}
  - {name: crate, shape: {name: circle, radius: 0.5}, state: [9, 6.5], appear_time: 2, color: "#000000"}
  - {name: sleeper, kinematics: {name: omni}, shape: {name: circle, radius: 0.5}, state: [3, 6.5], goal: [4, 6.5],
     behavior: {name: dash}, start_time: 60, color: "#000000", plot: {show_arrow: false}}
"""


def test_who_waits_is_pale_and_who_is_not_there_yet_is_not_drawn(workspace: Path, watched: Watched) -> None:
    irsim.run(text=LATE, steps=40, record=workspace / "late")
    page = watched.open(Path(irsim.replay(workspace / "late").file))

    def dark(x: float, y: float) -> float:
        settled(page)
        px, py = pixel_of(page, x, y)
        return 255 - max(page.evaluate(SHARE, [px - 3, py - 24, 6, 6]))  # above the middle, where there is no dart

    paper = dark(10.5, 3)
    scrub(page, 5)
    pale, asleep = dark(3, 4), dark(3, 6.5)
    assert pale > paper + 40
    assert asleep > paper + 20
    assert dark(6, 6.5) == dark(9, 6.5) == pytest.approx(paper, abs=15)
    scrub(page, 22)
    assert dark(3.2, 4) > pale + 40
    assert dark(6.2, 6.5) > asleep + 40
    assert dark(9, 6.5) > paper + 20
    assert dark(3, 6.5) == pytest.approx(asleep, abs=15)


def test_contacts_between_steps_are_marked_where_and_when_they_happen(workspace: Path, watched: Watched) -> None:
    """A row in the list, which leads to the moment within the step; a red mark at the place and on the time line."""
    run = recorded(tunnel())
    page = watched.open(Path(irsim.replay(run).file))
    assert page.inner_text("#facts").startswith("'runner' passed through 'board' between two steps at 2.31 s")
    rows = page.locator("#events button")
    assert [text.split("\n") for text in rows.all_inner_texts()] == [
        ["1.32 s", "runner touches post between two steps"],
        ["2.31 s", "runner passes through board between two steps"],
        ["3.30 s", "runner arrives"],
    ]
    rows.nth(1).click()
    settled(page)
    assert rows.nth(1).get_attribute("aria-current") == "true"
    assert value(page, "position") == "7.94, 3.00 m"  # where it touches the board, between 7.9 and 8.2
    x, y = pixel_of(page, 8.04, 3, world=(12, 6))
    red, green, blue = page.evaluate(SHARE, [x - 8, y - 9, 16, 18])
    assert red > 1.1 * max(green, blue)
    page.keyboard.press("]")
    settled(page)
    assert rows.nth(2).get_attribute("aria-current") == "true"
    page.keyboard.press("[")
    page.keyboard.press("[")
    settled(page)
    assert rows.nth(0).get_attribute("aria-current") == "true"


LEAVING = """\
world: {width: 12, height: 8, step_time: 0.1}
robot:
  - {name: early, kinematics: {name: omni}, shape: {name: circle, radius: 0.5}, state: [1, 7], goal: [11, 7],
     behavior: {name: dash}}
obstacle:
  - {name: gone, kinematics: {name: omni_angular}, shape: {name: circle, radius: 0.5}, color: "#000000",
     behavior: {name: replay, times: [0, 1], poses: [[2, 4], [4, 4]]}}
  - {name: coming, kinematics: {name: omni_angular}, shape: {name: circle, radius: 0.5}, color: "#000000",
     behavior: {name: replay, times: [3, 4], poses: [[8, 4], [10, 4]]}}
"""


def test_who_has_left_is_drawn_nowhere_and_neither_is_a_trail(workspace: Path, watched: Watched) -> None:
    irsim.run(text=LEAVING, steps=60, record=workspace / "leaving")
    page = watched.open(Path(irsim.replay(workspace / "leaving").file))

    def dark(x: float, y: float) -> float:
        settled(page)
        px, py = pixel_of(page, x, y)
        return 255 - max(page.evaluate(SHARE, [px - 8, py - 8, 16, 16]))

    paper = dark(6, 2)
    scrub(page, 10)
    assert min(dark(4, 4), dark(3, 4)) > paper + 10, "it is there, with a trail"
    assert dark(8, 4) == pytest.approx(paper, abs=4)
    scrub(page, 20)
    for x, y in ((4, 4), (3, 4), (2, 4), (8, 4), (0.3, 0.3)):
        assert dark(x, y) == pytest.approx(paper, abs=4), (x, y)
    scrub(page, 45)
    assert dark(10, 4) == pytest.approx(paper, abs=4)
    page.select_option("#robot", label="gone")
    assert value(page, "state") == "left at 1.00 s"
