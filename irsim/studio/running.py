"""A run of the text in the editor, sent as frames while it is simulated."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

from irsim import api
from irsim.common.text import clean
from irsim.scenario.limits import Limits
from irsim.studio.feed import END, Feed, Follower

__all__ = ["run"]


class _Frames(Feed):
    """A feed whose frames leave this process; no viewer holds a run of the editor, which is computed ahead.

    Args:
        put: Takes a frame: its kind and content.
    """

    def __init__(self, put: Callable[[int, bytes], None]) -> None:
        super().__init__()
        self._put = put

    def put(self, kind: int, content: bytes) -> None:
        """Pass a frame on."""
        self._put(kind, content)


def run(job: Mapping[str, Any], limits: Limits, put: Callable[[int, bytes], None]) -> dict[str, Any]:
    """Simulate one episode.

    Args:
        job: ``text``; ``seed``, ``steps``, ``policy`` and ``record`` as :func:`irsim.run` takes them.
        limits: Limits of the run.
        put: Takes a frame: its kind and content.

    Returns:
        The result.
    """
    followers = list[Follower]()

    def follow(simulation: Any, horizon: int) -> Follower:
        followers.append(Follower(_Frames(put), simulation, horizon))
        return followers[0]

    result = api.run(
        text=job["text"],
        seed=job.get("seed"),
        steps=job.get("steps"),
        policy=job.get("policy"),
        record=bool(job.get("record")),
        limits=limits,
        watched=follow,
    )
    followers[0].flush(last=True)
    reason = None if result.reason is None else clean(result.reason, 2000)
    ending = {"outcome": result.outcome, "status": "finished", "summary": clean(result.summary, 1000), "reason": reason}
    put(END, json.dumps(ending).encode())
    return result.model_dump(mode="json")
