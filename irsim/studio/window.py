"""The window of a run: the page, its server, and how both end."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING

from irsim.runs.replay.rows import ending_of
from irsim.studio.feed import END, Feed, Follower
from irsim.studio.live import live_server

if TYPE_CHECKING:
    from irsim.results.run import RunResult
    from irsim.simulation.simulation import Simulation
    from irsim.studio.server import Server

__all__ = ["Window"]

_GRACE_S = 3.0
"""Time in which a page that was closed may come back, as it does when it is loaded again [s]."""
_LOOK_S = 0.1


class Window:
    """The page of one run, as a context: the page is there from the start of the simulation to the end of the context.

    Args:
        say: Prints a line, such as the address of the page.
        port: Port of the server; 0 chooses a free one.
        browser: Whether to open the page in a browser, if there is a screen or ``BROWSER`` names one.
        speed: Speed of the playback at the start; None: real time.
    """

    def __init__(
        self, say: Callable[[str], None], *, port: int = 0, browser: bool = True, speed: float | None = None
    ) -> None:
        self._say, self._port, self._browser, self._speed = say, port, browser, speed
        self._feed = Feed()
        self._server: Server | None = None
        self._follower: Follower | None = None
        self._ended = False

    def follow(self, simulation: Simulation, horizon: int) -> Follower:
        """Open the page and show a simulation from its start on; what is returned is to be called after every step.

        Raises:
            InputError: The port cannot be used.
        """
        facts = {} if self._speed is None else {"speed": self._speed}
        self._follower = Follower(self._feed, simulation, horizon, **facts)
        self._server = live_server(self._port, self._feed)
        self._say(f"watch: {self._server.address}")
        if self._browser:
            self._server.show()
        return self._follower

    def end(self, result: RunResult) -> None:
        """Show how the run ended."""
        assert self._follower is not None
        self._follower.flush(last=True)
        self._put_end(status="finished", **ending_of(result))

    def _put_end(self, **ending: str | None) -> None:
        self._ended = True
        self._feed.put(END, json.dumps(ending).encode())

    def wait(self) -> None:
        """Wait until the page has been closed, or Ctrl-C, and say so."""
        with suppress(KeyboardInterrupt):
            self._say("the page stays until it is closed; Ctrl-C ends it now")
            while not self._is_closed():
                time.sleep(_LOOK_S)

    def _is_closed(self) -> bool:
        feed = self._feed
        return not feed.viewers and feed.left is not None and time.monotonic() - feed.left > _GRACE_S

    def __enter__(self) -> Window:
        return self

    def __exit__(self, kind: type[BaseException] | None, *error: object) -> None:
        """End the server; the page keeps what it has, and says so if the run is not over."""
        if self._follower is not None and not self._ended:
            what = "was interrupted" if kind is KeyboardInterrupt else "failed, and the terminal says why"
            summary = f"This run {what}; the page keeps what was simulated"
            self._put_end(outcome=None, status="interrupted", summary=summary, reason=None)
        self._feed.close()
        if self._server is not None:
            self._server.close()
