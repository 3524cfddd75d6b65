"""Objects that set off or appear later, on the page."""

from __future__ import annotations

from pathlib import Path

import pytest

import irsim
from tests.browser import Watched
from tests.runs.replay.browser.test_player import SHARE, pixel_of, scrub, settled

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
        return 255 - max(page.evaluate(SHARE, [px - 12, py - 12, 6, 6]))  # beside the middle, where goals have a cross

    paper = dark(10.5, 3)
    scrub(page, 5)
    pale, asleep = dark(3, 4), dark(3, 6.5)
    assert pale > paper + 40
    assert asleep == pytest.approx(pale, abs=15)
    assert dark(6, 6.5) == dark(9, 6.5) == pytest.approx(paper, abs=15)
    scrub(page, 22)
    assert min(dark(3.2, 4), dark(6.2, 6.5), dark(9, 6.5)) > pale + 40
    assert dark(3, 6.5) == pytest.approx(asleep, abs=15)
