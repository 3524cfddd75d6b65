"""A run of the text in the editor, sent as frames while it is simulated."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from irsim import api
from irsim.common.text import clean
from irsim.episodes.suitability import check_policy_name
from irsim.results.run import RunResult
from irsim.runs.reading import open_run
from irsim.runs.replay.data import pack_run
from irsim.runs.replay.page import page
from irsim.runs.replay.rows import ending_of
from irsim.scenario.limits import Limits
from irsim.studio.feed import END, RESULT, Feed, Follower

__all__ = ["page_of", "run"]


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


def run(job: Mapping[str, Any], limits: Limits, put: Callable[[int, bytes], None]) -> None:
    """Simulate one episode, or one for each of several seeds; the frames of each end with its result.

    Args:
        job: ``text``, ``seed``, ``steps`` and ``policy`` as :func:`irsim.run` takes them; ``seeds``: several of them.
        limits: Limits of a run.
        put: Takes a frame: its kind and content.
    """
    if (policy := job.get("policy")) is not None:
        check_policy_name(policy)
    for seed in job.get("seeds") or [job.get("seed")]:
        result = _run_one({**job, "seed": seed}, limits, put)
        put(RESULT, json.dumps(result.model_dump(mode="json")).encode())


def page_of(job: Mapping[str, Any], limits: Limits) -> dict[str, str]:
    """The replay page of an episode, as one HTML text that needs neither a server nor a network."""
    with TemporaryDirectory() as folder:
        seed, policy, kept = job.get("seed"), job.get("policy"), Path(folder, "run")
        api.run(text=job["text"], seed=seed, policy=policy, record=kept, limits=limits)
        packed = pack_run(open_run(kept), limits=replace(limits, root=folder))
    return {"html": page(packed.data, title=f"{clean(packed.head['title'])} · irsim replay")}


def _run_one(job: Mapping[str, Any], limits: Limits, put: Callable[[int, bytes], None]) -> RunResult:
    followers = list[Follower]()

    def follow(simulation: Any, horizon: int) -> Follower:
        followers.append(Follower(_Frames(put), simulation, horizon))
        return followers[0]

    result = api.run(
        text=job["text"],
        seed=job.get("seed"),
        steps=job.get("steps"),
        policy=job.get("policy"),
        limits=limits,
        watched=follow,
    )
    followers[0].flush(last=True)
    put(END, json.dumps({"status": "finished", **ending_of(result)}).encode())
    return result
