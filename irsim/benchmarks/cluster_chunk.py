"""Runs a chunk of episodes in a process of a cluster, which shares no files with the one that has asked for it."""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from irsim.benchmarks.episode import Task, run_task, scenario_of
from irsim.scenario.behavior_override import check_behavior_name

__all__ = ["check_jobs", "run_chunk"]

Data = dict[str, Any]
Fetch = Callable[[Any], bytes]


def run_chunk(shared: Mapping[str, Any], tasks: Sequence[tuple[int, int]], fetch: Fetch) -> str:
    """Run episodes.

    Args:
        shared: ``jobs``: the data of all jobs, in which maps are (name, name of the content); ``files``: references to
            contents by their names.
        tasks: Number of the job, and seed, of each episode.
        fetch: Returns the content that a reference stands for.

    Returns:
        JSON: ``answers``, of each episode its ``result`` or ``error``; and ``seconds``, how long they took.
    """
    begin, answers = time.monotonic(), list[Data]()
    with tempfile.TemporaryDirectory(prefix="irsim-maps-") as folder:
        jobs = {number: _with_maps(shared, number, Path(folder), fetch) for number in {number for number, _ in tasks}}
        for number, seed in tasks:
            answers.append(_answer(Task.of_data({"job": dict(jobs[number]), "seed": seed})))
    return json.dumps({"answers": answers, "seconds": time.monotonic() - begin})


def check_jobs(shared: Mapping[str, Any], numbers: Sequence[int], fetch: Fetch) -> str | None:
    """Read the scenarios of some jobs with their behaviors, and return what is wrong with the first one that fails."""
    with tempfile.TemporaryDirectory(prefix="irsim-maps-") as folder:
        for number in numbers:
            job = _with_maps(shared, number, Path(folder), fetch)
            try:
                scenario_of(Task.of_data({"job": job, "seed": 0}).job)
                check_behavior_name(job["behavior"])
            except Exception as error:
                return _text_of(error)
    return None


def _answer(task: Task) -> Data:
    try:
        return {"result": run_task(task)}
    except Exception as error:
        return {"error": _text_of(error)}


def _text_of(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"


def _with_maps(shared: Mapping[str, Any], number: int, folder: Path, fetch: Fetch) -> Data:
    """The data of a job whose maps are files of the folder."""
    job = dict(shared["jobs"][number])
    maps = []
    for name, content in job["maps"]:
        path = folder / content
        if not path.exists():
            path.write_bytes(fetch(shared["files"][content]))
        maps.append((name, str(path)))
    return {**job, "maps": maps}
