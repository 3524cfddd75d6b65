"""Runs a chunk of episodes in a process of a cluster, which shares no files with the one that has asked for it."""

from __future__ import annotations

import itertools
import json
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from irsim.benchmarks.episode import Job, policy_of, scenario_of
from irsim.benchmarks.together import run_together
from irsim.policies.catalog import with_file
from irsim.scenario.behavior_override import check_behavior_name

__all__ = ["check_jobs", "run_chunk"]

Data = dict[str, Any]
Fetch = Callable[[Any], bytes]


def run_chunk(shared: Mapping[str, Any], tasks: Sequence[tuple[int, int]], fetch: Fetch) -> str:
    """Run episodes.

    Args:
        shared: ``jobs``: the data of all jobs, in which files are names of contents; ``files``: references to contents
            by their names.
        tasks: Number of the job, and seed, of each episode.
        fetch: Returns the content that a reference stands for.

    Returns:
        JSON: ``answers``, of each episode its ``result`` or ``error``; and ``seconds``, how long they took.
    """
    begin, answers = time.monotonic(), list[Data]()
    with tempfile.TemporaryDirectory(prefix="irsim-maps-") as folder:
        for number, group in itertools.groupby(tasks, key=lambda task: task[0]):
            answers += _answers(_with_files(shared, number, Path(folder), fetch), [seed for _, seed in group])
    return json.dumps({"answers": answers, "seconds": time.monotonic() - begin})


def check_jobs(shared: Mapping[str, Any], numbers: Sequence[int], fetch: Fetch) -> str | None:
    """Read the scenarios of some jobs with their behaviors, and return what is wrong with the first one that fails."""
    with tempfile.TemporaryDirectory(prefix="irsim-maps-") as folder:
        for number in numbers:
            job = _with_files(shared, number, Path(folder), fetch)
            try:
                scenario_of(job)
                check_behavior_name(job.behavior)
                policy_of(job)
            except Exception as error:
                return _text_of(error)
    return None


def _answers(job: Job, seeds: Sequence[int]) -> list[Data]:
    """The answers of episodes that run together; after an error the others run one by one, so that it is one's own."""
    found, answers = run_together(job, seeds), list[Data]()
    for place in range(len(seeds)):
        try:
            answers.append({"result": next(found)})
        except Exception as error:
            if len(seeds) == 1:
                return [{"error": _text_of(error)}]
            return answers + [_answers(job, [one])[0] for one in seeds[place:]]
    return answers


def _text_of(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"


def _with_files(shared: Mapping[str, Any], number: int, folder: Path, fetch: Fetch) -> Job:
    """A job whose maps and network are files of the folder."""
    data = dict(shared["jobs"][number])

    def received(content: str, name: str | None = None) -> Path:
        path = folder / (name or content)
        if not path.exists():
            path.write_bytes(fetch(shared["files"][content]))
        return path

    data["maps"] = [(name, str(received(content))) for name, content in data["maps"]]
    network, beside = data.pop("network"), data.pop("beside")
    if network is not None:
        path = received(network)
        for suffix, content in beside:
            received(content, path.with_suffix(suffix).name)
        data["policy"] = with_file(data["policy"], path)
    return Job.of_data(data)
