"""The studio in headless Chromium, as an author of scenarios uses it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import irsim
from irsim.studio.studio import Studio
from tests.browser import until

pytestmark = pytest.mark.browser

SCENE = """\
# a hall
world: {width: 10, height: 8, time_limit: 20}   # m
robot:
  - name: rover   # it crosses
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.3}
    state: [2.0, 4, 0]
    goal: [8, 4]
    behavior: {name: dash}
obstacle:
  - {name: crate, shape: {name: rectangle, length: 1, width: 1}, state: [5, 6.5, 0]}
"""
Open = Callable[..., Any]


@pytest.fixture
def opened(chromium: Any, tmp_path: Path) -> Iterator[Any]:
    """The page with a file; afterwards: it wrote nothing to the console, and asked its server only."""
    (tmp_path / "hall.yaml").write_text(SCENE, encoding="utf-8")
    studio = Studio(tmp_path, first={"name": "hall.yaml"})
    context = chromium.new_context(viewport={"width": 1280, "height": 800}, color_scheme="light")
    page = context.new_page()
    problems, addresses = list[str](), list[str]()
    page.on("console", lambda message: problems.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.on("request", lambda request: addresses.append(request.url))
    page.goto(studio.address)
    until(page, "document.getElementById('state').className === 'good'", seconds=60)  # processes start meanwhile
    yield page
    origin = studio.address.partition("#")[0]
    context.close()
    studio.close()
    assert problems == []
    assert [address for address in addresses if not address.startswith((origin, "data:"))] == []


def text_of(page: Any) -> str:
    return str(page.evaluate("document.querySelector('.cm-content').cmTile.view.state.doc.toString()"))


def pixel(page: Any, x: float, y: float) -> tuple[float, float]:
    """Where a point of the hall is in the window: all of it is shown, 26 pixels from the nearer edges."""
    box = page.locator("#view").bounding_box()
    scale = min((box["width"] - 52) / 10, (box["height"] - 52) / 8)
    return box["x"] + box["width"] / 2 + (x - 5) * scale, box["y"] + box["height"] / 2 - (y - 4) * scale


def drag(page: Any, start: tuple[float, float], end: tuple[float, float], *, key: str | None = None) -> None:
    page.mouse.move(*pixel(page, *start))
    page.mouse.down()
    if key:
        page.keyboard.down(key)
    for share in (0.2, 0.6, 1.0):
        page.mouse.move(*pixel(page, *(a + share * (b - a) for a, b in zip(start, end, strict=True))))
    if key:
        page.keyboard.up(key)
    page.mouse.up()


def becomes(page: Any, text: str) -> None:
    for _ in range(600):
        if text_of(page) == text:
            return
        page.wait_for_timeout(50)
    assert text_of(page) == text


def test_a_drag_changes_one_line_and_is_undone_as_one_step(opened: Any) -> None:
    page = opened
    drag(page, (2, 4), (3.02, 5.48))
    moved = SCENE.replace("[2.0, 4, 0]", "[3, 5.5, 0]")
    becomes(page, moved)
    until(page, "document.querySelector('#values dd').textContent === '3.00, 5.50 m'")
    drag(page, (5, 6.5), (6, 6.5))
    becomes(page, moved.replace("[5, 6.5, 0]", "[6, 6.5, 0]"))
    page.click(".cm-content")
    page.keyboard.press("Control+z")
    becomes(page, moved)
    page.keyboard.press("Control+z")
    becomes(page, SCENE)
    page.keyboard.press("Control+y")
    becomes(page, moved)


def test_a_goal_is_dragged_and_a_drag_can_be_given_up(opened: Any) -> None:
    page = opened
    drag(page, (8, 4), (8, 2))
    becomes(page, SCENE.replace("goal: [8, 4]", "goal: [8, 2]"))
    page.mouse.move(*pixel(page, 2, 4))
    page.mouse.down()
    page.mouse.move(*pixel(page, 4, 4))
    page.keyboard.press("Escape")
    page.mouse.up()
    page.wait_for_timeout(300)
    assert text_of(page) == SCENE.replace("goal: [8, 4]", "goal: [8, 2]")


def test_a_mistake_is_underlined_while_typing_and_mended_by_a_click(opened: Any) -> None:
    page = opened
    page.click(".cm-content")
    page.keyboard.press("Control+End")
    page.keyboard.type("  - {shape: {name: circle, radus: 0.2}, state: [8, 7]}")
    typed = text_of(page)
    until(page, "document.querySelectorAll('#problems button:not(.line)').length === 1")
    [finding] = [one for one in irsim.validate(text=typed).findings if one.severity == "error"]
    assert finding.message in page.inner_text("#problems")
    assert page.locator(".cm-lintRange-error").inner_text() == "radus"
    page.locator("#problems button", has_text="Fix").click()
    becomes(page, typed.replace("radus", "radius"))
    until(page, "document.getElementById('state').className === 'good'")
    page.click(".cm-content")
    page.keyboard.press("Control+z")
    becomes(page, typed)


def test_words_are_completed_from_the_language(opened: Any) -> None:
    page = opened
    page.click(".cm-content")
    page.keyboard.press("Control+End")
    page.keyboard.type("  - {shape: {name: circle, rad")
    page.wait_for_selector(".cm-tooltip-autocomplete")
    assert page.inner_text(".cm-tooltip-autocomplete li >> nth=0").startswith("radius")
    assert "m, default 0.2" in page.inner_text(".cm-tooltip-autocomplete li >> nth=0")
    page.wait_for_timeout(1000)  # what has just appeared is not accepted by accident
    page.keyboard.press("Enter")
    page.keyboard.type("0.7")
    assert "{shape: {name: circle, radius: 0.7}}" in text_of(page)


def test_what_is_run_is_played_and_an_edit_shows_the_scene_again(opened: Any) -> None:
    page = opened
    page.click("#run")
    result = irsim.run(text=SCENE, seed=0)
    until(page, f"document.getElementById('outcome').textContent.endsWith('{result.outcome}')")
    until(page, "document.getElementById('run').textContent === 'Run'")
    assert page.inner_text("#state") == result.summary
    assert int(page.get_attribute("#time", "max")) == result.steps
    page.fill("#seed", "4")
    page.keyboard.press("Enter")
    until(page, "document.getElementById('outcome').textContent === 'written'")


def test_seeds_are_shown_side_by_side_and_one_of_them_is_played(opened: Any) -> None:
    page = opened
    page.click("#many")
    until(page, "document.getElementById('seeds').children.length === 20", seconds=60)
    until(page, "document.getElementById('many').textContent === '20 seeds'")
    assert page.inner_text("#state") == "20 × success"
    fourth = page.locator("#seeds button >> nth=3")
    assert fourth.inner_text() == "seed 3 success"
    fourth.click()
    until(page, "document.getElementById('facts').textContent.includes('seed 3')")
    assert fourth.get_attribute("aria-pressed") == "true"


def test_policies_are_compared_on_one_clock(opened: Any) -> None:
    page = opened
    page.click("#compare")
    assert page.is_disabled("#go"), "one alone cannot be compared"
    page.check("#choices input[value=orca]")
    page.check("#choices input[value=random]")
    page.click("#go")
    until(page, "!document.getElementById('compared').hidden", seconds=60)
    results = [irsim.run(text=SCENE, seed=0, policy=name) for name in (None, "orca", "random")]
    captions = page.locator("#pictures figcaption").all_inner_texts()
    names = ("as written", "orca", "random")
    assert captions == [f"{name} {result.outcome}" for name, result in zip(names, results, strict=True)]
    cells = page.locator("#differences tr >> nth=2").locator("td").all_inner_texts()
    assert cells[0] == f"{results[0].sim_time:g} s"
    assert cells[2].startswith(f"{results[2].sim_time:g} s (")
    assert int(page.get_attribute("#time", "max")) == max(result.steps for result in results)
    page.click("#single")
    until(page, "document.getElementById('outcome').textContent === 'written'")


def test_the_step_that_decided_is_a_click_away(opened: Any) -> None:
    page = opened
    drag(page, (5, 6.5), (5, 4))
    becomes(page, SCENE.replace("[5, 6.5, 0]", "[5, 4, 0]"))
    page.click("#run")
    page.wait_for_selector("#state button")
    result = irsim.run(text=text_of(page), seed=0)
    assert page.inner_text("#state button") == f"Go to step {result.decisive_step}"
    page.click("#state button")
    until(page, f"Number(document.getElementById('time').value) === {result.decisive_step}")


def test_keys_move_copy_and_remove_the_chosen_object(opened: Any) -> None:
    page = opened
    page.mouse.click(*pixel(page, 5, 6.5))
    page.keyboard.press("ArrowLeft")
    becomes(page, SCENE.replace("[5, 6.5, 0]", "[4.95, 6.5, 0]"))
    page.keyboard.press("Shift+ArrowDown")
    becomes(page, SCENE.replace("[5, 6.5, 0]", "[4.95, 6, 0]"))
    page.keyboard.press("Delete")
    until(page, "document.getElementById('view').getAttribute('aria-label').includes('0 other objects')")
    assert "crate" not in text_of(page)


def test_objects_are_added_copied_and_removed(opened: Any) -> None:
    page = opened
    page.click("[data-add=circle]")
    until(page, "document.getElementById('view').getAttribute('aria-label').includes('2 other objects')")
    assert text_of(page).startswith(SCENE)
    page.mouse.click(*pixel(page, 5, 6.5))
    until(page, "document.getElementById('picked').textContent === 'crate'")
    page.click("#duplicate")
    until(page, "document.getElementById('view').getAttribute('aria-label').includes('3 other objects')")
    assert "name: crate_2" in text_of(page)
    assert "state: [5.5, 6, 0]" in text_of(page)
    page.click("#remove")
    until(page, "document.getElementById('view').getAttribute('aria-label').includes('2 other objects')")


def test_a_file_is_saved_and_a_change_by_others_is_noticed(opened: Any, tmp_path: Path) -> None:
    page = opened
    drag(page, (2, 4), (3, 4))
    becomes(page, moved := SCENE.replace("[2.0, 4, 0]", "[3, 4, 0]"))
    page.keyboard.press("Control+s")
    page.click(".cm-content")
    page.keyboard.press("Control+s")
    until(page, "!document.getElementById('save').classList.contains('changed')")
    assert (tmp_path / "hall.yaml").read_text() == moved
    (tmp_path / "hall.yaml").write_text(SCENE)
    page.on("dialog", lambda dialog: dialog.dismiss())
    page.click("#save")
    page.wait_for_timeout(500)
    assert (tmp_path / "hall.yaml").read_text() == SCENE
