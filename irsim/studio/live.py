"""The page of a run that is being simulated: ``POST /stream`` sends its frames, ``POST /command`` holds the simulation.

The page itself holds nothing of a run.
"""

from __future__ import annotations

import re
from collections.abc import AsyncIterator
from functools import partial
from pathlib import Path
from typing import Any, TypeGuard

import anyio.to_thread
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response, StreamingResponse
from starlette.routing import Route

from irsim.runs.replay.page import page
from irsim.studio.feed import ALIVE, Feed, frame
from irsim.studio.server import Refused, Server, given

__all__ = ["live_server", "stream"]

_MAX_STEPS = 10_000
"""Largest number of steps of one command."""
_ALIVE_S = 1.0
"""Time after which a viewer is sent a frame without content, which shows whether it is still there [s]."""
_POLICY = re.compile(r'http-equiv="Content-Security-Policy" content="([^"]*)"')


def live_server(port: int, feed: Feed) -> Server:
    """A server of the page and of the frames of a feed.

    Raises:
        InputError: The port is not free, or may not be used.
    """
    text = page(title="irsim run", feed=Path(__file__).with_name("web"))
    policy = _POLICY.search(text)
    assert policy is not None
    headers = {"Content-Security-Policy": f"{policy[1]}; frame-ancestors 'none'"}  # which browsers do not read in pages

    async def show(_: Request) -> Response:
        return HTMLResponse(text, headers=headers)

    async def send(request: Request) -> Response:
        return stream(feed, (await given(request)).get("from"))

    async def command(request: Request) -> Response:
        _command(feed, await given(request))
        return Response(status_code=204)

    routes = [
        Route("/", show, methods=["GET"]),
        Route("/stream", send, methods=["POST"]),
        Route("/command", command, methods=["POST"]),
    ]
    return Server(port, routes)


def stream(feed: Feed, number: Any) -> StreamingResponse:
    """The frames of a feed from a number on, until it is closed.

    Raises:
        Refused: ``number`` is not a number of a frame.
    """
    if not _is_count(number):
        raise Refused(400, 'write from which frame on: {"from": 0}')

    async def frames() -> AsyncIterator[bytes]:
        at = number
        feed.enter()
        try:
            while True:
                wait = partial(feed.after, at, _ALIVE_S)
                new = await anyio.to_thread.run_sync(wait, abandon_on_cancel=True)
                at += len(new)
                if not new and feed.closed:
                    return
                for one in new or [frame(ALIVE, at)]:
                    yield one
        finally:
            feed.leave()

    kept = {"Connection": "close"}  # no other request can follow on it
    return StreamingResponse(frames(), headers=kept, media_type="application/octet-stream")


def _command(feed: Feed, wanted: dict[str, Any]) -> None:
    hold, steps = wanted.get("hold"), wanted.get("steps")
    if wanted.keys() == {"hold"} and isinstance(hold, bool):
        feed.hold(hold)
    elif wanted.keys() == {"steps"} and _is_count(steps) and 0 < steps <= _MAX_STEPS:
        feed.advance(steps)
    else:
        raise Refused(400, 'write {"hold": true}, {"hold": false} or {"steps": 1}')


def _is_count(value: Any) -> TypeGuard[int]:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0
