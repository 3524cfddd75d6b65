"""The page of a benchmark in Chromium: it sorts, fits a phone, follows the theme, and its charts answer."""

from __future__ import annotations

import html
import json
import re
from pathlib import Path
from typing import Any

import pytest

from irsim.api.benchmark_report import write_report
from irsim.benchmarks.stored import run_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.graphics.scene.theme import DARK, LIGHT
from tests.browser import Watched, until

pytestmark = pytest.mark.browser

SUITE = """\
suite: walls
version: 1
title: Robots among walls
scenarios:
  - name: wall
    vary: {"robot[0].number": [1, 2, 3]}
    scenario:
      world: {width: 10, height: 10, time_limit: 12}
      robot:
        - number: 1
          kinematics: {name: diff}
          distribution: {name: circle, center: [5, 5, 0], radius: 4}
      obstacle: [{name: wall, shape: {name: rectangle, length: 0.4, width: 2}, state: [5, 5, 0]}]
seeds: {first: 0, count: 2}
seconds: 12
protocols: [freeze]
policies: {dash: dash, orca: orca}
"""
SEEN = """[...document.querySelector('table').rows].slice(0, 4).map(row => [...row.cells].slice(0, 2).map(cell => {
  const { x, y, width, height } = cell.getBoundingClientRect();
  const over = document.elementFromPoint(x + width - 4, y + height / 2);
  return cell.contains(over) && x + width < innerWidth / 2 + 60 ? cell.textContent.trim() : "hidden"; }))"""
"""The part in sight of the first two cells of the first rows."""
READY = "document.querySelectorAll('th button').length > 0"


def reported(folder: Path, suite: str) -> Path:
    (folder / "walls.yaml").write_text(suite, encoding="utf-8")
    plan = suite_plan(str(folder / "walls.yaml"), seeds=2)
    return write_report(run_plan(plan, folder / "run", workers=1), folder / "run").page


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return reported(tmp_path_factory.mktemp("report"), SUITE)


@pytest.fixture(scope="module")
def wide_report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report with rows over all scenarios, and with intervals."""
    suite = SUITE.replace("circle, center: [5, 5, 0], radius: 4", "random").replace("[freeze]", "[freeze, yield]")
    return reported(tmp_path_factory.mktemp("report"), suite)


def column(page: Any, number: int) -> list[str]:
    cells: list[str] = page.evaluate(
        f"[...document.querySelector('tbody').rows].map(row => row.cells[{number}].textContent)"
    )
    return cells


def test_a_click_on_a_heading_sorts_and_says_so(report: Path, watched: Watched) -> None:
    page = watched.open(report, READY)
    headings = page.evaluate("[...document.querySelectorAll('thead')][0].innerText").split("\t")
    assert [heading.strip() for heading in headings[:4]] == ["scenario", "policy", "episodes", "success"]
    page.click("th:nth-child(4) button")
    shares = [float(text.partition("%")[0]) for text in column(page, 3)]
    assert shares == sorted(shares)
    assert page.get_attribute("th:nth-child(4)", "aria-sort") == "ascending"
    page.focus("th:nth-child(4) button")
    page.keyboard.press("Enter")
    assert page.get_attribute("th:nth-child(4)", "aria-sort") == "descending"
    assert [float(text.partition("%")[0]) for text in column(page, 3)] == sorted(shares, reverse=True)
    page.click("th:nth-child(2) button")
    assert column(page, 1) == sorted(column(page, 1))
    assert page.get_attribute("th:nth-child(4)", "aria-sort") == "none"
    assert all(column(page, 0))  # each row says its scenario, wherever it has moved
    assert not watched.problems


def test_the_whole_heading_is_a_button_and_a_third_click_restores_the_order(report: Path, watched: Watched) -> None:
    page = watched.open(report, READY)
    written = [column(page, number) for number in range(4)]
    cell = page.locator("th:nth-child(4)").first
    box = cell.bounding_box()
    for order in ("ascending", "descending", "none"):
        page.mouse.click(box["x"] + box["width"] - 3, box["y"] + box["height"] / 2)  # beside the word
        assert cell.get_attribute("aria-sort") == order
    assert [column(page, number) for number in range(4)] == written
    assert page.evaluate("document.querySelector('table').classList.contains('sorted')") is False


def test_a_phone_scrolls_tables_and_not_the_page(report: Path, watched: Watched) -> None:
    page = watched.open(report, READY)
    page.set_viewport_size({"width": 390, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    wide = "document.querySelector('.wide')"
    assert page.evaluate(f"{wide}.scrollWidth > {wide}.clientWidth && getComputedStyle({wide}).overflowX === 'auto'")
    until(page, "!document.querySelector('.hint').hidden")
    assert "scroll it sideways" in page.inner_text(".hint")
    left = "document.querySelector('tbody td').getBoundingClientRect().left"
    before = page.evaluate(left)
    page.evaluate(f"{wide}.scrollLeft = 120")
    assert page.evaluate(left) == before  # the names of the scenarios stay
    page.set_viewport_size({"width": 1600, "height": 800})
    until(page, "document.querySelector('.hint').hidden")


def test_a_phone_always_shows_scenario_and_policy(wide_report: Path, watched: Watched) -> None:
    page = watched.open(wide_report, READY)
    page.set_viewport_size({"width": 390, "height": 800})
    for scroll in (0, 150, 400):
        page.evaluate(f"document.querySelector('.wide').scrollLeft = {scroll}")
        rows = page.evaluate(SEEN)
        assert rows[0] == ["scenario", "policy"]
        assert rows[1:] == [["(all)/freeze", "dash"], ["(all)/freeze", "orca"], ["(all)/yield", "dash"]]


def test_a_printed_table_fits_the_sheet_and_breaks_no_interval(wide_report: Path, watched: Watched) -> None:
    page = watched.open(wide_report, READY)
    page.set_viewport_size({"width": 1040, "height": 720})  # of A4, sideways
    page.emulate_media(media="print")
    assert page.evaluate("document.documentElement.scrollWidth") <= 1040
    signs = "[...document.querySelectorAll('th button')].map(one => getComputedStyle(one, '::after').content)"
    assert set(page.evaluate(signs)) == {"none"}
    lines = "[...document.querySelectorAll('.whole')].map(one => one.getClientRects().length)"
    assert set(page.evaluate(lines)) == {1}
    assert page.evaluate("getComputedStyle(document.querySelector('td')).position") == "static"


@pytest.mark.parametrize("theme", [LIGHT, DARK], ids=["light", "dark"])
def test_page_and_charts_have_the_colours_of_the_theme(report: Path, watched: Watched, theme: Any) -> None:
    page = watched.open(report, READY)
    page.emulate_media(color_scheme=theme.name)
    back, text = page.evaluate(
        "[getComputedStyle(document.body).backgroundColor, getComputedStyle(document.querySelector('svg text')).fill]"
    )
    for shown, wanted in ((back, theme.page), (text, theme.ink)):
        assert [int(part) for part in shown[4:-1].split(",")] == [int(wanted[k : k + 2], 16) for k in (1, 3, 5)]


def test_charts_and_replays_say_what_they_show(report: Path, watched: Watched) -> None:
    page = watched.open(report, READY)
    titles = page.evaluate("[...document.querySelectorAll('svg title')].map(title => title.textContent)")
    assert any(title == "wall-2, dash: success 0%" for title in titles)
    assert any("time to goal [s]: median" in title for title in titles)
    captions = page.evaluate("[...document.querySelectorAll('.episode figcaption a')].map(link => link.textContent)")
    assert any(text.startswith("seed 0: ") and "collided with 'wall' at " in text for text in captions)


def test_all_failed_seeds_have_a_command(report: Path, watched: Watched) -> None:
    page = watched.open(report, READY)
    table = page.locator("h3", has_text="All failed seeds").locator("xpath=following-sibling::div[1]/table")
    rows = [row.split("\t") for row in table.locator("tbody").inner_text().splitlines()]
    result = json.loads((report.parent / "results.json").read_text(encoding="utf-8"))
    failed = [one for one in result["episodes"] if one["outcome"] in ("collision", "timeout")]
    assert sum(int(row[3]) for row in rows) == len(failed) > 0
    first = next(one for one in failed if one["scenario"] == rows[0][0])
    assert rows[0][5].startswith("irsim run ")
    assert f"/{first['scenario']} --seed {first['seed']} --policy {rows[0][1]} --record" in rows[0][5]


def test_a_link_and_its_replay_say_the_same(report: Path, watched: Watched) -> None:
    links = re.findall(r'<a href="(replays/[^"]+)">([^<]*)</a>', report.read_text(encoding="utf-8"))
    target, caption = next((target, html.unescape(text)) for target, text in links if "collided with" in text)
    form = r"seed (\d+): (\S+) collided with '(.*)' at ([\d.]+) s.* \((.*)\)"
    seed, robot, other, time, scene = re.findall(form, caption)[0]
    opened = watched.open(report.parent / target, "document.getElementById('facts').textContent")
    assert opened.inner_text("#title") == f"{scene}, seed {seed}"
    hit = re.findall(rf"'{robot}' hit '{other}' at ([\d.]+) s", opened.inner_text("#facts"))[0]
    assert float(time) == pytest.approx(float(hit), abs=0.051)
