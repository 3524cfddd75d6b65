"""The page of a run while it is simulated, as a user meets it."""

from __future__ import annotations

import time
from threading import Event
from typing import Any

import pytest

from tests.browser import until
from tests.runs.replay import beliefs
from tests.runs.replay.browser.test_player import pixel_of, settled, time_of, value
from tests.runs.replay.conftest import HOSTILE, scene
from tests.studio.browser.conftest import Start

pytestmark = pytest.mark.browser

STEPS = "Number(document.getElementById('time').max)"


def slowly() -> None:
    """A step that takes a while, as with many robots."""
    time.sleep(0.02)


def test_the_token_is_gone_from_the_address_and_from_scripts(start: Start) -> None:
    watched = start(scene())
    watched.finish()
    page = watched.page
    assert page.url.endswith("/")
    assert page.evaluate("document.cookie") == ""
    [cookie] = page.context.cookies()
    assert (cookie["httpOnly"], cookie["sameSite"]) == (True, "Strict")
    assert watched.window._server is not None
    assert watched.window._server.access.token not in page.content()
    page.reload()
    until(page, f"{STEPS} > 0")
    assert page.title() == "world · irsim run"


def test_it_plays_at_once_and_stays_with_the_last_state(start: Start) -> None:
    watched = start(scene(), speed=16)
    result, page = watched.finish(), watched.page
    until(page, f"document.getElementById('time').value == {result.steps}")
    assert page.get_attribute("#play", "aria-label") == "Play"
    assert page.inner_text("#outcome") == "collision"
    assert page.inner_text("#facts") == f"{result.reason or result.summary} · 3 robots · seed 1", "as the terminal says"
    assert page.locator("#hold").is_hidden()
    x, y, _ = result.robots[0].pose
    page.select_option("#robot", label="rover")
    assert value(page, "position") == f"{x:.2f}, {y:.2f} m"
    assert page.locator("#events button").count() == int(page.inner_text("#eventshead").split("(")[1][:-1]) > 0


def test_the_run_grows_while_one_looks_at_what_was(start: Start) -> None:
    go_on = Event()
    watched = start(scene(), lambda: go_on.wait(30) and None)
    page = watched.page
    assert page.inner_text("#outcome") == "simulating"
    assert page.inner_text("#facts").startswith("simulated until 0.00 s of at most 8.00 s")
    assert "Nothing has happened yet." in page.inner_text("#events")
    assert page.get_attribute("#play", "aria-label") == "Pause", "it waits for what is simulated next"
    go_on.set()
    watched.finish()
    page.keyboard.press("Space")
    page.keyboard.press("Home")
    settled(page)
    assert time_of(page) == 0
    assert value(page, "position") == "1.00, 1.00 m"
    page.keyboard.press("ArrowRight")
    settled(page)
    assert time_of(page) == 1


def test_the_outcome_is_what_comes_until_its_end_is_shown(start: Start) -> None:
    watched = start(scene(), speed=0.1)
    result, page = watched.finish(), watched.page
    page.keyboard.press("Space")
    page.keyboard.press("Home")
    settled(page)
    assert page.inner_text("#outcome") == "ends with: collision"
    assert page.get_attribute("#outcome", "class") == "badge ", "without the colour of the outcome"
    assert page.inner_text("#facts").startswith(f"simulated until {result.steps * 0.1:.2f} s, its end · 3 robots")
    colour = "getComputedStyle(document.querySelector('#events button:not([aria-current]) span')).color"
    to_come = page.evaluate(colour)
    page.keyboard.press("End")
    settled(page)
    assert page.inner_text("#outcome") == "collision"
    assert page.evaluate(colour) != to_come, "events that are still to come are pale"
    page.keyboard.press("Home")
    settled(page)
    assert page.inner_text("#outcome") == "collision", "it stays known"


def test_pause_and_scrubbing_leave_the_simulation_alone(start: Start) -> None:
    watched = start(scene(), slowly, steps=150)
    page = watched.page
    until(page, f"{STEPS} > 5")
    page.keyboard.press("Space")
    page.keyboard.press("Home")
    before = page.evaluate(STEPS)
    until(page, f"{STEPS} > {before + 20}")
    assert time_of(page) == 0
    page.locator("#time").evaluate("time => { time.value = 4; time.dispatchEvent(new Event('input')) }")
    settled(page)
    assert time_of(page) == 4
    watched.finish()
    assert time_of(page) == 4


def test_hold_single_steps_and_go_on(start: Start) -> None:
    watched = start(scene(), slowly, steps=150)
    page = watched.page
    until(page, f"{STEPS} > 3")
    page.keyboard.press("h")
    assert page.inner_text("#hold") == "Go on"
    held = settled_steps(page)
    page.keyboard.press("Space")
    page.keyboard.press("End")
    page.keyboard.press("ArrowRight")
    until(page, f"{STEPS} === {held + 1}")
    until(page, f"document.getElementById('time').value == {held + 1}")
    page.keyboard.press("Shift+ArrowRight")
    until(page, f"document.getElementById('time').value == {held + 11}")
    assert settled_steps(page) == held + 11
    page.click("#hold")
    assert page.inner_text("#hold") == "Hold"
    watched.finish()


def settled_steps(page: Any) -> int:
    """Number of steps once no more come."""
    counts = [-1, page.evaluate(STEPS)]
    while counts[-1] != counts[-2]:
        page.wait_for_timeout(400)
        counts.append(page.evaluate(STEPS))
    return int(counts[-1])


def test_a_robot_is_followed_and_named_by_a_click(start: Start) -> None:
    watched = start(scene())
    watched.finish()
    page = watched.page
    page.keyboard.press("Space")
    page.keyboard.press("Home")
    settled(page)
    x, y = pixel_of(page, 11, 1)
    page.locator("#view").click(position={"x": x, "y": y})
    assert page.locator("#robot option:checked").inner_text() == "slider"
    page.click("#follow")
    settled(page)
    box = page.locator("#view").bounding_box()
    page.locator("#view").hover(position={"x": box["width"] / 2, "y": box["height"] / 2})
    assert page.inner_text("#tip").startswith("slider")


def test_a_second_page_and_one_that_comes_late_show_all(start: Start) -> None:
    watched = start(scene())
    result, page = watched.finish(), watched.page
    late = page.context.new_page()
    late.goto(page.url)
    until(late, f"document.getElementById('time').max == {result.steps}")
    until(late, "document.getElementById('outcome').textContent.endsWith('collision')")


def test_it_says_that_a_run_was_interrupted_and_keeps_it(start: Start) -> None:
    watched = start(scene(), slowly, steps=150)
    page = watched.page
    until(page, f"{STEPS} > 5")
    watched.window.__exit__(KeyboardInterrupt)
    until(page, "document.getElementById('outcome').textContent === 'interrupted'")
    assert page.inner_text("#facts").startswith("This run was interrupted; the page keeps what was simulated")
    assert page.locator("#hold").is_hidden()
    page.keyboard.press("Space")
    page.keyboard.press("Home")
    settled(page)
    assert value(page, "position") == "1.00, 1.00 m"


def test_it_says_that_irsim_is_gone(start: Start) -> None:
    """As after a kill."""
    watched = start(scene(), slowly, steps=100)
    page = watched.page
    page.route("**/stream", lambda route: route.abort())
    watched.window._feed.put(9, b"")  # no kind of frame
    page.evaluate("window.stop()")
    until(page, "document.getElementById('outcome').textContent === 'ended'", seconds=30)
    assert "irsim has ended; what was simulated until then stays here" in page.inner_text("#facts")
    watched.problems = [one for one in watched.problems if "ERR_FAILED" not in one]


def test_any_speed_can_be_asked_for(start: Start) -> None:
    watched = start(scene(), speed=3)
    watched.finish()
    page = watched.page
    assert page.input_value("#speed") == "3"
    page.keyboard.press(".")
    assert page.input_value("#speed") == "4"
    page.keyboard.press(",")
    assert page.input_value("#speed") == "2"


def test_who_has_no_token_sees_nothing(start: Start, chromium: Any) -> None:
    watched = start(scene())
    watched.finish()
    context = chromium.new_context()
    page = context.new_page()
    page.goto(watched.page.url)
    until(page, "document.getElementById('message').textContent === 'open the address that irsim has printed.'")
    assert page.get_attribute("#time", "max") == "0"
    context.close()


def test_hostile_names_stay_text(start: Start) -> None:
    watched = start(scene(HOSTILE))
    watched.finish()
    page = watched.page
    page.select_option("#robot", index=2)
    page.keyboard.press("n")
    page.locator("#events button.collision").first.click()
    settled(page)
    assert page.locator("#robot option").nth(2).inner_text().startswith("</script><script>window.hacked=1</script>")
    assert page.evaluate("window.hacked") is None
    assert page.locator("img").count() == 0
    assert page.locator("script").count() == 2


def test_a_narrow_window(start: Start) -> None:
    go_on = Event()
    watched = start(scene(), lambda: go_on.wait(30) and None)
    page = watched.page
    page.set_viewport_size({"width": 390, "height": 760})
    settled(page)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert page.locator("#view").bounding_box()["height"] > 200
    for name in ("play", "hold", "speed"):
        box = page.locator(f"#{name}").bounding_box()
        assert box["x"] + box["width"] <= 390, name
    go_on.set()
    watched.finish()


def test_beliefs_grow_with_the_run(start: Start) -> None:
    watched = start(beliefs.SCENE, speed=16)
    result, page = watched.finish(), watched.page
    until(page, f"document.getElementById('time').value == {result.steps}")
    page.select_option("#robot", label="lost")
    assert page.locator("#belief").is_visible()
    told = value(page, "believes")
    off = float(told.rpartition("off by ")[2].removesuffix(" m"))
    assert 0 < off < 2
    page.keyboard.press("Home")
    assert value(page, "believes") != told
