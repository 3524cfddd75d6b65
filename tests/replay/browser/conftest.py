"""Headless Chromium and pages in it. ``nox -s browser`` brings both; IRSIM_CHROMIUM names another Chromium."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import irsim
from irsim.runs import Run

SWITCHES = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
NAMES = ("chromium", "chromium-browser", "google-chrome")
CROWD = """\
world: {width: 40, height: 40, time_limit: 100, step_time: 0.1, collision_mode: unobstructed}
robot:
  - number: 100
    kinematics: {name: diff}
    behavior: {name: dash, wander: true, range_low: [1, 1, -3.14], range_high: [39, 39, 3.14]}
    distribution: {name: random, range_low: [1, 1, -3], range_high: [39, 39, 3]}
    shape: {name: circle, radius: 0.2}
    sensors: [{name: lidar2d, number: 180, range_max: 8}]
obstacle:
  - number: 20
    distribution: {name: random, range_low: [2, 2, 0], range_high: [38, 38, 0]}
    shape: {name: circle, radius: 0.6}
"""


class Watched:
    """A page and what went wrong in it."""

    def __init__(self, page: Any) -> None:
        self.page = page
        self.problems: list[str] = []
        self.requests: list[str] = []
        page.on("console", lambda message: self.problems.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: self.problems.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))

    def open(self, path: Path) -> Any:
        """Show a file; the page, once its run is there."""
        self.page.goto(path.resolve().as_uri())
        until(self.page, "document.getElementById('time').max > 0")
        return self.page


def until(page: Any, condition: str, seconds: float = 15.0) -> None:
    """Wait for a condition in the page, asked from outside: the page itself allows no ``eval``."""
    end = time.monotonic() + seconds
    while not page.evaluate(condition):
        assert time.monotonic() < end, f"in vain: {condition}"
        time.sleep(0.02)


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    from playwright.sync_api import sync_playwright

    found = os.environ.get("IRSIM_CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
    assert found is not None, "no Chromium on PATH and none named by IRSIM_CHROMIUM; `nox -s browser` brings one"
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=found, args=SWITCHES)
        yield browser
        browser.close()


@pytest.fixture
def watched(chromium: Any) -> Iterator[Watched]:
    """A new page; afterwards: it wrote nothing to the console, and asked for nothing but itself."""
    context = chromium.new_context(viewport={"width": 1200, "height": 760}, color_scheme="light", offline=True)
    watched = Watched(context.new_page())
    yield watched
    context.close()
    assert watched.problems == []
    assert [address for address in watched.requests if not address.startswith("file:")] == []
    assert len(watched.requests) <= 1


@pytest.fixture
def shown(run: Run, watched: Watched) -> Any:
    """The page of a run with three robots."""
    return watched.open(Path(irsim.replay(run).file))


@pytest.fixture(scope="session")
def crowd(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Page of a hundred robots over a thousand steps."""
    folder = tmp_path_factory.mktemp("crowd")
    irsim.run(text=CROWD, seed=1, steps=1000, record=folder / "run")
    target = folder / "crowd.html"
    result = irsim.replay(folder / "run", target)
    assert (result.last_step, result.every) == (1000, 1)
    return target
