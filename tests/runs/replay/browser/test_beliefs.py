"""Beliefs of robots on the page of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.runs import open_run
from tests.browser import Watched
from tests.runs.replay.beliefs import SCENE
from tests.runs.replay.browser.test_player import pixel_of, scrub, settled, value
from tests.runs.replay.conftest import recorded, scene

pytestmark = pytest.mark.browser

PIXELS = """([x, y, reach]) => {
    const view = document.getElementById('view'), ratio = view.width / view.clientWidth;
    const side = Math.round(2 * reach * ratio);
    const copy = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
    copy.canvas.width = copy.canvas.height = side;
    copy.drawImage(view, (reach - x) * ratio, (reach - y) * ratio);
    return Array.from(copy.getImageData(0, 0, side, side).data);
}"""
"""Pixels of the view around a place."""
ROW = 30


def changed_around(page: Any, key: str, x: float, y: float, reach: float) -> int:
    """Number of pixels around a place of the world that a switch changes."""
    shown, where = [], [*pixel_of(page, x, y), reach]
    for _ in range(2):
        settled(page)
        shown.append(np.array(page.evaluate(PIXELS, where)).reshape(-1, 4))
        page.keyboard.press(key)
    return int((shown[0] != shown[1]).any(axis=1).sum())


def test_a_belief_is_drawn_told_and_switched_off(workspace: Path, watched: Watched) -> None:
    run = recorded(SCENE, steps=40)
    trace = run.trace()
    page = watched.open(Path(irsim.replay(run).file))
    page.select_option("#robot", label="lost")
    scrub(page, ROW)
    told = trace.readings["lost/localization"][ROW]
    true = trace.pose[ROW, 0]
    off = float(np.hypot(told["x"] - true[0], told["y"] - true[1]))
    assert value(page, "believes") == f"({told['x']:.2f}, {told['y']:.2f}), off by {off:.2f} m"
    assert page.get_attribute("#belief", "aria-pressed") == "true"
    assert changed_around(page, "b", told["x"], told["y"], 40) > 60
    tracks = trace.readings["lost/detector"][ROW]
    c, s = np.cos(true[2]), np.sin(true[2])
    ahead = np.array([c, s])
    places = []
    for track in tracks[np.isfinite(tracks["id"])]:
        place = true[:2] + track["x"] * ahead + track["y"] * np.array([-s, c])
        places.append((int(track["object"]), *place))
    assert {one[0] for one in places} == {-1, 1}, "a false track and a true one"
    for followed, x, y in places:
        if 0.5 < x < 11.5 and 0.5 < y < 7.5:
            assert changed_around(page, "b", x, y, 8) > 20, followed
    page.click("#belief")
    assert page.get_attribute("#belief", "aria-pressed") == "false"
    page.select_option("#robot", label="sure")
    with pytest.raises(KeyError):
        value(page, "believes")
    assert watched.problems == []


def test_an_arrival_in_belief_has_a_hollow_mark(workspace: Path, watched: Watched) -> None:
    run = open_run(str(irsim.run(text=SCENE, seed=1, record=True).run_id))
    assert "believed_arrival" in [event.kind for event in run.events]
    page = watched.open(Path(irsim.replay(run).file))
    mark = page.locator("#events .believed_arrival i")
    assert "lost believes to be at its goal" in page.inner_text("#events")
    assert mark.evaluate("mark => getComputedStyle(mark).backgroundColor") == "rgba(0, 0, 0, 0)"
    assert mark.evaluate("mark => parseFloat(getComputedStyle(mark).borderTopWidth)") >= 1
    assert watched.problems == []


def test_a_page_without_beliefs_has_no_switch(workspace: Path, watched: Watched) -> None:
    page = watched.open(Path(irsim.replay(recorded(scene())).file))
    assert page.locator("#belief").is_hidden()
    page.keyboard.press("b")
    settled(page)
    assert watched.problems == []
