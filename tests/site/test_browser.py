"""The site in Chromium: it is accessible, fits a phone, and its players play; nothing is written to the console."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

from irsim.bundled import templates
from tests.browser import until

pytestmark = [pytest.mark.site, pytest.mark.one_python]

PROBLEMS = ("error", "warning")
PAGES = (
    "index", "start/robotics", "start/from-ir-sim", "gallery/index", "gallery/crossing", "reference/index",
    "reference/behavior/orca", "reference/codes", "reference/commands/run", "reference/tools", "reference/python/irsim",
    "skills/irsim-scenario/SKILL", "skills/irsim-benchmark/results/referee", "realism/index", "realism/imu",
    "realism/sweep", "suites/index", "CHANGELOG", "search",
)  # fmt: skip


@pytest.fixture(scope="module")
def axe() -> str:
    return (Path(os.environ["IRSIM_NPM"]) / "axe-core" / "axe.min.js").read_text(encoding="utf-8")


def _page(chromium: Any, scheme: str, width: int = 1200) -> Any:
    context = chromium.new_context(viewport={"width": width, "height": 800}, color_scheme=scheme)
    page = context.new_page()
    page.problems = []
    page.on("console", lambda message: page.problems.append(message.text) if message.type in PROBLEMS else None)
    page.on("pageerror", lambda error: page.problems.append(str(error)))
    return page


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_no_serious_finding_of_accessibility(chromium: Any, address: str, axe: str, scheme: str) -> None:
    page, findings = _page(chromium, scheme), []
    for name in PAGES:
        page.goto(f"{address}/{name}.html")
        page.add_script_tag(content=axe)
        result = page.evaluate("axe.run(document, {iframes: false})")
        for one in result["violations"]:
            if one["impact"] in ("serious", "critical"):
                findings.append(f"{name}: {one['id']}: {one['nodes'][0]['html'][:200]} ({len(one['nodes'])})")
    page.context.close()
    assert findings == []


def test_pages_fit_a_phone(chromium: Any, address: str) -> None:
    page, wide = _page(chromium, "light", width=390), []
    for name in PAGES:
        page.goto(f"{address}/{name}.html")
        if page.evaluate("document.documentElement.scrollWidth") > 390:
            wide.append(name)
    page.context.close()
    assert wide == []


def test_pages_write_nothing_to_the_console(chromium: Any, address: str) -> None:
    page = _page(chromium, "light")
    for name in PAGES:
        page.goto(f"{address}/{name}.html")
    problems = page.problems
    page.context.close()
    assert problems == []


def test_players_start(chromium: Any, address: str) -> None:
    page, idle = _page(chromium, "light"), []
    for name in templates.names():
        page.goto(f"{address}/players/{name}.html")
        until(page, "document.getElementById('time').max > 0")
        if page.evaluate("document.querySelector('canvas') === null"):
            idle.append(name)
    problems = page.problems
    page.context.close()
    assert (problems, idle) == ([], [])


def test_a_gallery_page_shows_its_player(chromium: Any, address: str) -> None:
    page = _page(chromium, "light")
    page.goto(f"{address}/gallery/crossing.html")
    page.locator("iframe.irsim-player").scroll_into_view_if_needed()
    frame = page.frame_locator("iframe.irsim-player")
    canvas = frame.locator("canvas").first
    canvas.wait_for(timeout=15_000)
    world = canvas.bounding_box()
    page.context.close()
    assert world is not None
    assert world["width"] > 800, "the world uses the width of the page"
    assert world["height"] > 450


def test_the_search_page_answers(chromium: Any, address: str) -> None:
    page = _page(chromium, "light")
    page.goto(f"{address}/search.html?q=lidar+noise")
    page.locator("#search-results li a").first.wait_for(timeout=15_000)
    firsts = page.locator("#search-results li a").evaluate_all("links => links.slice(0, 3).map((one) => one.href)")
    page.context.close()
    assert any("reference/sensor" in one or "references/lidars" in one for one in firsts), firsts


def test_a_hit_has_an_excerpt_and_shows_its_heading(chromium: Any, address: str) -> None:
    page = _page(chromium, "light", width=390)
    page.goto(f"{address}/search.html?q=unknown-key")
    page.locator("#search-results li p.context").first.wait_for(timeout=15_000)
    until(page, "document.querySelector('.search-summary').innerText.includes('found')")
    assert "is not part of the language" in page.locator("#search-results li").first.inner_text()
    page.locator("#search-results li a").first.click()
    page.wait_for_url("**/codes.html*#unknown-key")
    until(page, "document.querySelector('#unknown-key').getBoundingClientRect().top < 300")
    heading, bar = (
        "document.querySelector('h3#unknown-key').getBoundingClientRect()",
        "document.querySelector('header')",
    )
    assert page.evaluate(f"{heading}.top - {bar}.getBoundingClientRect().bottom") >= 0
    assert page.problems == []
    page.context.close()


def test_a_misspelt_word_is_answered_with_the_nearest(chromium: Any, address: str) -> None:
    page = _page(chromium, "light")
    page.goto(f"{address}/search.html?q=polcy")
    page.locator("#search-results li a").first.wait_for(timeout=15_000)
    assert "No page has “polcy”: these have “policy”." in page.locator("#search-results").inner_text()
    page.context.close()


def test_options_keep_their_dashes(html: Path) -> None:
    text = (html / "reference" / "codes.html").read_text(encoding="utf-8")
    assert "irsim policies --for FILE" in text.replace("<span>", "").replace("</span>", "")
    assert "\N{EN DASH}for" not in text
