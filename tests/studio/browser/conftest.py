"""The page of ``irsim run --watch`` in headless Chromium, with the simulation in a thread of the test."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from threading import Thread
from typing import Any

import pytest

from irsim import api
from irsim.results.run import RunResult
from irsim.studio.window import Window
from tests.browser import until

Start = Callable[..., "Watched"]


class Watched:
    """A page in a browser, the window that serves it, and the run."""

    def __init__(self, page: Any, window: Window, text: str, pace: Callable[[], Any], **options: Any) -> None:
        self.page, self.window = page, window
        self.problems: list[str] = []
        self.requests: list[str] = []
        self.result: RunResult | None = None
        page.on("console", lambda message: self.problems.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: self.problems.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))
        self._thread = Thread(target=self._run, args=[text, pace], kwargs=options, daemon=True)

    def _run(self, text: str, pace: Callable[[], Any], **options: Any) -> None:
        def watched(simulation: Any, horizon: int) -> Callable[[int, int], None]:
            follower = self.window.follow(simulation, horizon)

            def each(done: int, total: int) -> None:
                pace()
                follower(done, total)

            return each

        result = api.run(text=text, seed=1, watched=watched, **options)
        self.window.end(result)
        self.result = result

    def open(self, said: list[str]) -> None:
        """Open the page as a user does, at the address that is printed."""
        self._thread.start()
        while not said:
            assert self._thread.is_alive() or said
        self.page.goto(said[0].removeprefix("watch: "))
        until(self.page, "document.getElementById('robot').options.length > 0")

    def finish(self) -> RunResult:
        """Wait until the page says how the run ends."""
        self._thread.join(60)
        assert self.result is not None
        until(self.page, f"document.getElementById('outcome').textContent.endsWith('{self.result.outcome}')")
        return self.result


@pytest.fixture
def start(chromium: Any) -> Iterator[Start]:
    """Start a run and open its page; afterwards: it wrote nothing to the console, and asked its server only."""
    context = chromium.new_context(viewport={"width": 1200, "height": 760}, color_scheme="light")
    opened = list[tuple[Watched, str]]()

    def call(text: str, pace: Callable[[], Any] = lambda: None, speed: float | None = None, **options: Any) -> Watched:
        said = list[str]()
        window = Window(said.append, browser=False, speed=speed)
        watched = Watched(context.new_page(), window, text, pace, **options)
        watched.open(said)
        opened.append((watched, said[0].removeprefix("watch: ").partition("#")[0]))
        return watched

    yield call
    context.close()
    for watched, origin in opened:
        watched.window.__exit__(None)
        assert watched.problems == []
        assert [address for address in watched.requests if not address.startswith((origin, "data:"))] == []
