"""Headless Chromium and pages in it. ``nox -s browser`` brings both; IRSIM_CHROMIUM names another Chromium."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

__all__ = ["Watched", "chromium", "until", "watched"]

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


class Watched:
    """A page and what went wrong in it."""

    def __init__(self, page: Any) -> None:
        self.page = page
        self.problems: list[str] = []
        self.requests: list[str] = []
        page.on("console", lambda message: self.problems.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: self.problems.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))

    def open(self, path: Path, ready: str = "document.getElementById('time').max > 0") -> Any:
        """Show a file; the page, once a condition holds, which for a run is that it is there."""
        self.page.goto(path.resolve().as_uri())
        until(self.page, ready)
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

    program = os.environ.get("IRSIM_CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
    assert program is not None, "no Chromium on PATH, and IRSIM_CHROMIUM is not set; `nox -s browser` brings one"
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=SWITCHES)
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
