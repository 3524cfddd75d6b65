"""Run many episodes on a Ray cluster; results come in the order of the tasks and equal a local run's.

Tasks are sent in chunks whose size follows from how long episodes take: large enough that sending them costs little,
small enough that little is lost with a process. Scenarios and maps travel once, so that machines need no common files.
"""

from __future__ import annotations

import itertools
import json
import tempfile
import time
from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from irsim.benchmarks.episode import Job, Task, policy_of, run_task, scenario_of
from irsim.benchmarks.pool import MAX_DEATHS, cores, dead_workers
from irsim.benchmarks.ray_connection import ClusterError, connected
from irsim.benchmarks.together import run_together
from irsim.common.hashing import digest
from irsim.common.installed import version
from irsim.common.text import clean
from irsim.policies.catalog import file_of, files_beside, has_inner_files, with_file
from irsim.scenario.behavior_override import check_behavior_name
from irsim.simulation.engine import program

__all__ = ["ClusterError", "run_on_cluster"]

_CHUNK_S = 5.0
"""Time that a chunk should take [s]: sending one costs some milliseconds."""
_POLL_S = 0.1
"""Time between two looks at what has ended [s]."""
_COUNT_S = 2.0
"""Time between two looks at how many cores the cluster has, which may grow [s]."""
_FIRST_S = 600.0
"""Time within which a process of the cluster must take the first task [s]; clusters that grow need minutes."""


def run_on_cluster(
    tasks: Sequence[Task],
    *,
    address: str,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    kept: Callable[[int, dict[str, Any]], None] | None = None,
) -> list[dict[str, Any]]:
    """Run episodes on a cluster.

    A chunk whose process or machine dies is run again, episode by episode. An episode that ends with an error there is
    run here, where the error has its type.

    Args:
        tasks: The tasks; their jobs name their maps.
        address: See :func:`irsim.benchmarks.ray_connection.connected`.
        workers: Greatest number of chunks at a time; default: as many as the cluster has cores.
        progress: Callback ``(episodes_done, episodes_total)``.
        kept: Callback ``(number_of_the_task, result)``, called for each result as it comes.

    Returns:
        The results, in the order of the tasks.

    Raises:
        ExtraError: Ray is not installed.
        ClusterError: No cluster answers, its version of irsim is another one, or it lacks a module or behavior.
        WorkerError: Several processes have died in the same episode.
        IrsimError: The first error of an episode, in the order of the tasks.
    """
    if not tasks:
        return []
    results: dict[int, dict[str, Any]] = {}

    def keep(index: int, result: dict[str, Any]) -> None:
        if kept is not None:
            kept(index, result)
        results[index] = result

    jobs = list(dict.fromkeys(task.job for task in tasks))
    number = {job: place for place, job in enumerate(jobs)}
    queue = _Queue(len(tasks))
    with connected(address, workers or cores()) as ray:
        shared = ray.put(_shared(ray, jobs))
        remote = ray.remote(max_retries=0, num_cpus=1)(_remote_function())
        _check(ray, remote, shared, jobs)
        running: dict[Any, list[int]] = {}
        size = _Size(ray, workers)
        try:
            while True:
                while len(running) < size.chunks() and (chunk := queue.take(size.cores)):
                    wanted = [(number[tasks[index].job], tasks[index].seed) for index in chunk]
                    running[remote.remote(program(), shared, wanted, [])] = chunk
                if not running:
                    if (index := queue.failed()) is None:
                        break
                    keep(index, run_task(tasks[index]))
                    queue.go_on()
                ready = ray.wait(list(running), num_returns=len(running), timeout=_POLL_S)[0] if running else []
                for ref in ready:
                    _take_in(ray, ref, running.pop(ref), tasks, queue, keep)
                if progress is not None and ready:
                    progress(len(results), len(tasks))
        finally:
            for ref in running:
                with suppress(Exception):  # the connection may be lost
                    ray.cancel(ref, force=True)
    return [results[index] for index in range(len(tasks))]


def _take_in(
    ray: Any, ref: Any, chunk: list[int], tasks: Sequence[Task], queue: _Queue, keep: Callable[[int, Any], None]
) -> None:
    """Store a chunk's results and requeue its tasks without a result."""
    try:
        answer = ray.get(ref)
    except ray.exceptions.RayError as error:
        if (dead := queue.died(chunk)) is not None:
            failure = dead_workers(tasks[dead])
            raise type(failure)(f"{failure.message} ({clean(_first_line(error), 200)})", failure.fix or "") from None
        return
    _raise_if_unfit(answer)
    data = json.loads(answer["chunk"])
    queue.took(data["seconds"] / len(chunk))
    for index, one in zip(chunk, data["answers"], strict=True):
        if "result" in one:
            keep(index, one["result"])
        else:
            queue.stop(index)


def _first_line(error: Exception) -> str:
    return next(iter(str(error).splitlines()), type(error).__name__)


class _Queue:
    """The tasks that are to be sent, by their numbers."""

    def __init__(self, count: int) -> None:
        self._waiting = deque(range(count))
        self._risky: deque[int] = deque()  # tasks whose process has died, each sent on its own
        self._held: list[int] = []  # tasks after one that failed
        self._failed: list[int] = []
        self._deaths = Counter[int]()
        self._seconds = 0.0

    def take(self, cores: int) -> list[int]:
        """The next chunk; empty if nothing is to be sent at present."""
        if self._risky:
            return [self._risky.popleft()]
        wanted = int(_CHUNK_S / self._seconds) if self._seconds else 1
        fair = -(-len(self._waiting) // (2 * cores))  # so that all cores end at about the same time
        return [self._waiting.popleft() for _ in range(min(max(1, min(wanted, fair)), len(self._waiting)))]

    def took(self, seconds: float) -> None:
        """Note how long an episode has taken, as a mean in which the last chunks count most."""
        seconds = max(seconds, 1e-4)
        self._seconds = 0.8 * self._seconds + 0.2 * seconds if self._seconds else seconds

    def died(self, chunk: list[int]) -> int | None:
        """Give back a chunk whose process has died; returns a task in which too many have died."""
        if len(chunk) == 1:
            self._deaths[chunk[0]] += 1
            if self._deaths[chunk[0]] >= MAX_DEATHS:
                return chunk[0]
        self._risky.extend(chunk)
        return None

    def stop(self, index: int) -> None:
        """Hold back the tasks after one that failed, so that the first error is the one that is raised."""
        self._failed.append(index)
        first = min(self._failed)
        self._held += [one for one in (*self._risky, *self._waiting) if one > first]
        self._risky = deque(one for one in self._risky if one < first)
        self._waiting = deque(one for one in self._waiting if one < first)

    def failed(self) -> int | None:
        """The first task that failed, once all before it are done; None if none did."""
        return min(self._failed, default=None)

    def go_on(self) -> None:
        """Go on after the first task that failed, which has been done elsewhere."""
        self._failed.remove(min(self._failed))
        if not self._failed:
            self._waiting, self._held = deque(sorted(self._held)), []


class _Size:
    """How many cores the cluster has, and how many chunks are sent at a time."""

    def __init__(self, ray: Any, workers: int | None) -> None:
        self._ray, self._workers = ray, workers
        self._counted = -_COUNT_S
        self.cores = 1

    def chunks(self) -> int:
        """Twice the cores, so that none waits for its next chunk, or the number that was asked for."""
        if time.monotonic() - self._counted >= _COUNT_S:
            self._counted = time.monotonic()
            self.cores = self._workers or max(1, int(self._ray.cluster_resources().get("CPU", 1)))
        return self._workers or 2 * self.cores


def _shared(ray: Any, jobs: Sequence[Job]) -> dict[str, Any]:
    """Data that all chunks share: the jobs as data, and the contents of their maps and networks, each sent once."""
    files: dict[str, Any] = {}
    job_data = []

    def sent(path: Path) -> str:
        content = path.read_bytes()
        key = f"{digest(content)}{path.suffix}"
        if key not in files:
            files[key] = ray.put(content)
        return key

    for job in jobs:
        if job.local is not None:
            what = f"policy {job.local.name!r} exists only in this program, so a cluster cannot run it"
            raise ClusterError("cluster-differs", what, "make it a plug-in or a file, or run without the cluster")
        if job.policy is not None and has_inner_files(job.policy):
            what = "files that are named within a policy are not sent to a cluster"
            raise ClusterError("cluster-differs", what, "run without the cluster")
        network = None if job.policy is None else file_of(job.policy)
        beside = [] if network is None else [path for path in files_beside(network) if path.is_file()]
        job_data.append(
            asdict(job)
            | {
                "maps": [(name, sent(Path(path))) for name, path in job.maps],
                "network": None if network is None else sent(network),
                "beside": [(path.suffix, sent(path)) for path in beside],
            }
        )
    return {"jobs": job_data, "files": files}


def _remote_function() -> Callable[..., Mapping[str, Any]]:
    """The function that the cluster runs.

    It is sent by value, as functions in functions are, so that it also runs where irsim is missing or another one.
    """

    def run(
        expected: str, shared: Mapping[str, Any], tasks: Sequence[tuple[int, int]], checked: Sequence[int]
    ) -> Mapping[str, Any]:
        import platform

        import ray

        try:
            from irsim.benchmarks.cluster import check_jobs, run_chunk
            from irsim.simulation.engine import program
        except ImportError as error:
            return {"missing": str(error), "node": platform.node()}
        if program() != expected:
            return {"version": program(), "node": platform.node()}
        if checked and (problem := check_jobs(shared, checked, ray.get)) is not None:
            return {"problem": problem, "node": platform.node()}
        return {"chunk": run_chunk(shared, tasks, ray.get)}

    return run


def _check(ray: Any, remote: Any, shared: Any, jobs: Sequence[Job]) -> None:
    """Check that the cluster has this version of irsim, and every module and behavior; with one scenario each.

    Raises:
        ClusterError: See :func:`run_on_cluster`.
    """
    first = {(job.behavior, job.imports): place for place, job in reversed(list(enumerate(jobs)))}
    ref = remote.remote(program(), shared, [], sorted(first.values()))
    try:
        answer = ray.get(ref, timeout=_FIRST_S)
    except ray.exceptions.GetTimeoutError:
        ray.cancel(ref, force=True)
        what = f"no core of the cluster was free within {_FIRST_S:g} s"
        raise ClusterError("no-cluster", what, "look at `ray status`; then --resume") from None
    except ray.exceptions.RayError as error:
        what = f"the cluster cannot run a first task: {clean(_first_line(error), 300)}"
        raise ClusterError("no-cluster", what, "look at the log of the cluster; then --resume") from None
    _raise_if_unfit(answer)


def _raise_if_unfit(answer: Mapping[str, Any]) -> None:
    """Raise what keeps a machine of the cluster from running episodes."""
    node = clean(answer.get("node", ""), 80)
    if "missing" in answer:
        what = f"irsim cannot be imported on {node}: {clean(answer['missing'], 200)}"
        fix = f"install irsim-mcp {version()} on every machine of the cluster"
    elif "version" in answer:
        what = f"{node} has irsim {clean(answer['version'])}, and this is irsim {program()}: their results may differ"
        fix = f"install irsim-mcp {version()} on every machine of the cluster"
    elif "problem" in answer:
        what = f"{node} cannot run what this process can: {clean(answer['problem'], 400)}"
        fix = "install your own modules on every machine, and pass modules with behaviors to --import"
    else:
        return
    raise ClusterError("cluster-differs", what, fix)


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
    results, answers = run_together(job, seeds), list[Data]()
    for place in range(len(seeds)):
        try:
            answers.append({"result": next(results)})
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
