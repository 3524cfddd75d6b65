"""The page with long texts, many robots, long lists, and with nothing in it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import irsim
import irsim.runs.replay.data as packing
from irsim.runs import Run, open_run
from tests.browser import Watched
from tests.runs.replay.browser.test_player import ALL, FRAMES, SHARE, scrub, settled
from tests.runs.replay.conftest import recorded, scene

pytestmark = pytest.mark.browser

REASON = "; ".join(f"robot_with_a_long_name_{k} was 3.42 m from its goal and stood for 12.0 s" for k in range(9))


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("width", [390, 1000, 1280])
def test_long_reasons_and_names_have_room(workspace: Path, watched: Watched, width: int, theme: str) -> None:
    slow = scene("lorry_" * 13).replace("name: slider", "name: slider\n    vel_max: [0.02, 0.02]")
    run = recorded(slow, steps=2000)
    assert run.events[-1].time > 100
    path = run.folder / "result.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "reason": REASON}))
    watched.page.set_viewport_size({"width": width, "height": 800})
    watched.page.emulate_media(color_scheme=theme)
    page = watched.open(Path(irsim.replay(open_run(run.id)).file))
    page.select_option("#robot", index=2)

    def fits() -> None:
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        for name in ("title", "outcome", "facts", "help", "robot", "names", "events", "speed"):
            box = page.locator(f"#{name}").bounding_box()
            assert box["x"] >= 0, name
            assert box["x"] + box["width"] <= width, name

    fits()
    assert page.locator("#facts").bounding_box()["height"] < 50
    assert REASON in page.get_attribute("#facts", "title")
    page.get_by_role("button", name="more").click()
    settled(page)
    assert page.locator("#facts").bounding_box()["height"] > 50
    assert page.locator("#facts").evaluate(
        "facts => facts.scrollHeight <= facts.clientHeight || getComputedStyle(facts).overflowY === 'auto'"
    )
    fits()
    page.get_by_role("button", name="less").click()
    settled(page)
    assert page.locator("#facts").bounding_box()["height"] < 50
    heights = page.locator("#events button time").evaluate_all("all => all.map(time => time.offsetHeight)")
    assert max(heights) < 30


def test_it_says_what_the_record_lacks(run: Run, watched: Watched) -> None:
    shown = watched.open(Path(irsim.replay(run).file))
    assert not shown.locator("#recordnote").is_visible()
    path = run.folder / "run.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "trace_until": 7}))
    watched.requests.clear()
    watched.open(Path(irsim.replay(open_run(run.id)).file))
    assert shown.inner_text("#recordnote") == f"This run: recorded until step 7 of {run.last_step}: size limit."


def test_more_is_offered_only_where_there_is_more(shown: Any) -> None:
    assert not shown.locator("#more").is_visible()


def test_it_says_which_events_are_not_listed(run: Run, watched: Watched, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packing, "MAX_EVENTS", 1)
    page = watched.open(Path(irsim.replay(run).file))
    assert page.text_content("#eventshead") == f"Events (1 of {len(run.events)})"
    assert page.inner_text("#events").endswith("hits crate")
    assert page.inner_text("#leftout") == "Not listed, evenly over time: 2 arrivals."


def test_a_hundred_robots_are_small_and_fast(crowd: Path, watched: Watched) -> None:
    assert crowd.stat().st_size < 3_000_000
    page = watched.open(crowd)
    page.keyboard.press("r")
    medians = {}
    for way in ("all", "following"):
        scrub(page, 600)
        page.keyboard.press("Space")
        medians[way] = min(page.evaluate(FRAMES) for _ in range(2))
        page.keyboard.press("Space")
        page.keyboard.press("f")
    assert max(medians.values()) <= 67  # four of the screen's frames, with room for what else the machine does
    assert page.get_attribute("#names", "aria-pressed") == "false", "a hundred names hide the robots"


def test_long_trails_are_complete_soon_wherever_one_comes_from(crowd: Path, watched: Watched) -> None:
    page = watched.open(crowd)

    def at_rest() -> list[float]:
        looks = [page.evaluate(SHARE, ALL), []]
        while looks[-1] != looks[-2]:
            for _ in range(3):
                settled(page)
            looks.append(page.evaluate(SHARE, ALL))
        return looks[-1]

    looks = []
    for before in (0, 990, 899):
        scrub(page, before)
        settled(page)
        scrub(page, 900)
        looks.append(at_rest())
    for look in looks[1:]:
        assert look == pytest.approx(looks[0], abs=0.1)
    page.keyboard.press("t")
    assert at_rest() != pytest.approx(looks[0], abs=1)


def test_long_lists_of_events_move_along(crowd: Path, watched: Watched) -> None:
    page = watched.open(crowd)
    current = page.locator("#events button[aria-current]")
    page.keyboard.press("End")
    settled(page)
    assert page.locator("#events button").count() <= 300
    last = page.locator("#events button").last
    assert last.get_attribute("aria-current") == "true"
    last.click()
    page.keyboard.press("Home")
    settled(page)
    assert current.count() == 0 or current.inner_text().startswith("0.")
    page.keyboard.press("]")
    settled(page)
    assert current.evaluate("button => button === document.activeElement || document.activeElement === document.body")
    box, held = current.bounding_box(), page.locator("#events").bounding_box()
    assert held["y"] <= box["y"] < held["y"] + held["height"]


def test_an_empty_page_says_so(workspace: Path, watched: Watched) -> None:
    from irsim.runs.replay.page import page

    (workspace / "empty.html").write_text(page())
    watched.page.goto((workspace / "empty.html").as_uri())
    assert "no run in this page" in watched.page.inner_text("#message")


def test_a_run_with_nothing_in_it(workspace: Path, watched: Watched) -> None:
    run = recorded(
        "world: {width: 5, height: 5}\nobstacle: [{state: [1, 1, 0], shape: {name: circle, radius: 0.2}}]\n", steps=3
    )
    page = watched.open(Path(irsim.replay(run).file), "document.getElementById('events').innerText !== ''")
    page.keyboard.press("r")
    page.keyboard.press("f")
    page.keyboard.press("]")
    assert page.locator("#robot option").all_inner_texts() == ["none"]
    assert "Nothing happened" in page.inner_text("#events")
