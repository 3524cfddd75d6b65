"""The page of a report in headless Chromium, as a reader uses it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from irsim_evals.grader.outcome import Cost, Mark
from irsim_evals.report.content import content_of
from irsim_evals.report.load import Proof
from irsim_evals.report.page import page
from irsim_evals.results import Results
from tests.browser import Watched, until
from tests.evals.conftest import SCENARIO, trial

pytestmark = pytest.mark.browser

HOSTILE = "</script><script>window.hacked=1</script><img src=x onerror=window.hacked=1>"
LONG = "a" * 300
WIDTHS = (380, 1400)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A page with passes, failures, several attempts, pictures, long words and hostile texts."""
    marks = [Mark(points=[[6, 4]], text="goal"), Mark(points=[[1, 1], [6, 4]])]
    cost = Cost(calls=12, errors=1, tokens=20_000, seconds=31.5)
    trials = [
        *(trial("corridor", k == 1, "rules", number=k, category="geometry") for k in (1, 2, 3)),
        trial("corridor", False, "skill", marks=marks, path="robot.goal", cost=cost, category="geometry"),
        trial("corridor", True, "skill+mcp", cost=cost, category="geometry"),
        trial("speed", True, "rules", reply=HOSTILE),
        trial("speed", False, "skill", files={"scenario.yaml": SCENARIO + f"# {HOSTILE} {LONG}\n"}, path="robot"),
        trial("speed", True, "skill+mcp", reply=LONG),
        trial(HOSTILE, False, "skill", category="units", files={LONG + ".py": HOSTILE}),
    ]
    rows = [{"kind": "gold", "operator": LONG, "trials": 9, "wrong": 0}]
    content = content_of(Results(trials=trials), title=f"Evals {HOSTILE}", proof=Proof.model_validate({"rows": rows}))
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(page(content), encoding="utf-8")
    return path


@pytest.fixture
def report(written: Path, watched: Watched) -> Any:
    """The page; that it writes nothing to the console and asks for nothing but itself, ``watched`` checks."""
    return watched.open(written, ready="document.getElementById('count').textContent !== ''")


def shown(page: Any, what: str) -> list[str]:
    """Texts of the elements that can be seen."""
    return [text.strip() for text in page.locator(f"{what}:visible").all_inner_texts()]


def open_all(page: Any) -> None:
    page.evaluate("document.querySelectorAll('details').forEach(one => { one.open = true })")
    until(page, "document.querySelectorAll('image[href]').length > 0")


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_is_wider_than_the_window(report: Any, width: int, scheme: str) -> None:
    report.emulate_media(color_scheme=scheme)
    until(report, f"document.documentElement.dataset.theme === '{scheme}'")
    report.set_viewport_size({"width": width, "height": 800})
    assert report.evaluate("document.documentElement.scrollWidth") <= width
    open_all(report)
    assert report.evaluate("document.documentElement.scrollWidth") <= width
    wide = "one => one.getBoundingClientRect().right > innerWidth + 1"
    outside = (
        f"[...document.querySelectorAll('section, summary, figure svg, pre, dl, #filters > *')].filter({wide}).length"
    )
    assert report.evaluate(outside) == 0


def test_filters_show_what_was_asked_for(report: Any) -> None:
    assert report.inner_text("#count") == "3 of 3 cases, 9 of 9 answers"
    report.select_option("#arm", "skill")
    assert report.inner_text("#count") == "3 of 3 cases, 3 of 9 answers"
    report.select_option("#arm", "")
    report.select_option("#result", "1")
    assert shown(report, "details.case .id") == ["corridor", "speed"]
    assert shown(report, ".chip") == ["✓ rules 1", "✓ skill+mcp", "✓ rules", "✓ skill+mcp"]
    report.select_option("#category", "geometry")
    assert shown(report, "details.case .id") == ["corridor"]
    report.select_option("#category", "")
    report.select_option("#result", "")
    report.fill("#words", "SPEED")
    assert shown(report, "details.case .id") == ["speed"]
    report.fill("#words", "title corridor, nothing")
    assert shown(report, "details.case .id") == ["corridor"]
    report.fill("#words", "corridor nothing")
    assert report.inner_text("#count") == "0 of 3 cases, 0 of 9 answers"


def test_a_failure_shows_its_evidence_and_the_place(report: Any) -> None:
    report.locator("#corridor > summary").click()
    failed = report.locator('#corridor details.trial[data-arm="skill"]')
    failed.locator("> summary").click()
    until(report, "document.querySelectorAll('image[href]').length === 2")
    text = failed.inner_text()
    assert "radius 0.2" in text
    assert "scenario.yaml line 6" in text
    assert failed.locator("svg circle.mark").count() == 1
    assert failed.locator("svg polyline.mark").count() == 1
    assert failed.locator(".code .marked").inner_text() == "  goal: [6, 4, 0]"
    loaded = """Promise.all([...document.querySelectorAll('image[href]')].map(async image => {
        const copy = new Image();
        copy.src = image.href.baseVal;
        await copy.decode();
        return copy.width;
    }))"""
    assert report.evaluate(loaded) == [400, 400]


def test_everything_can_be_reached_with_the_keyboard(report: Any) -> None:
    for _ in range(40):
        report.keyboard.press("Tab")
        if report.evaluate("document.activeElement.parentElement.id") == "corridor":
            break
    report.keyboard.press("Enter")
    assert report.evaluate("document.getElementById('corridor').open")
    report.keyboard.press("Tab")
    report.keyboard.press("Enter")
    assert report.locator("#corridor details.trial[open]").count() == 1


def test_dark_and_light(report: Any) -> None:
    colors = "['--page', '--ink'].map(name => getComputedStyle(document.documentElement).getPropertyValue(name))"
    light = report.evaluate(colors)
    report.emulate_media(color_scheme="dark")
    until(report, "document.documentElement.dataset.theme === 'dark'")
    assert report.evaluate(colors) != light
    report.locator("#theme").click()
    assert report.evaluate(colors) == light


def test_texts_of_answers_do_nothing(report: Any) -> None:
    open_all(report)
    assert report.evaluate("window.hacked") is None
    assert report.locator("img").count() == 0
    assert HOSTILE in report.inner_text('#speed details.trial[data-arm="rules"] .prose')


def test_a_link_opens_its_case(written: Path, watched: Watched) -> None:
    watched.page.goto(written.resolve().as_uri() + "#speed")
    until(watched.page, "document.getElementById('speed').open")
