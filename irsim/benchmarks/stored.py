"""Runs a benchmark in a folder, where it can go on after any interruption as if there had been none.

Every episode is written as soon as it is done (``episodes.jsonl``). At the end the result is written, and the episodes
again in their order: a run that was interrupted and resumed has the same files as an undisturbed one.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from pydantic_core import PydanticSerializationError

from irsim.benchmarks.comparison import benchmark
from irsim.benchmarks.log import in_order, with_episodes
from irsim.benchmarks.plan import Plan, map_hashes
from irsim.benchmarks.preparation import Prepared, prepare
from irsim.benchmarks.timing import was_timed
from irsim.common.files import TEMPORARY, code_of, write_atomically
from irsim.common.installed import version
from irsim.common.records import ContentError, read_json
from irsim.episodes.episode import Progress
from irsim.results.benchmark import BenchmarkResult, EpisodeRow, SuiteResult, SuiteScenarioFacts
from irsim.runs.clock import date_now
from irsim.runs.files import RunError, unreadable
from irsim.scenario.limits import Limits

__all__ = [
    "EPISODES",
    "PLAN",
    "RESULTS",
    "TIMING",
    "default_folder",
    "last_folder",
    "measure_plan",
    "prepare_plan",
    "read_plan",
    "result_of_episodes",
    "result_of_plan",
    "resume_benchmark",
    "run_plan",
]

EPISODES, PLAN, RESULTS, TIMING = "episodes.jsonl", "plan.json", "results.json", "timing.json"
"""Files in the folder of a benchmark: its episodes, everything that decides its numbers, its result, and how long
policies took to decide, which is the only file that differs between two runs of a plan."""
_FOLDER = Path(".irsim") / "benchmarks"


def default_folder(plan: Plan) -> Path:
    """The folder of a plan below the current one; its name ends with the hash of the plan."""
    return _FOLDER / f"{plan.name}-{plan.hash}"


def last_folder() -> Path:
    """The folder below the current one in which a benchmark was started last.

    Raises:
        RunError: No benchmark was started here.
    """
    plans = _plans()
    if not plans:
        raise RunError("no-benchmark", f"{_FOLDER} holds no benchmark", "name its folder with -o")
    return plans[0].parent


def _plans() -> list[Path]:
    """The plans below the current folder, the one started last first."""
    return sorted(_FOLDER.glob(f"*/{PLAN}"), key=lambda path: path.stat().st_mtime_ns, reverse=True)


def run_plan(
    plan: Plan,
    folder: Path,
    *,
    resume: bool = False,
    workers: int | None = None,
    cluster: str | None = None,
    progress: Progress | None = None,
    limits: Limits | None = None,
    finish: Callable[[BenchmarkResult, Path], object] | None = None,
) -> BenchmarkResult:
    """Run a plan, and write its episodes and its result into a folder.

    Args:
        plan: The plan.
        folder: The folder, which is made.
        resume: Go on with what an interrupted run of the same plan has left there.
        workers: Greatest number of processes; the files do not depend on it.
        cluster: Address of a Ray cluster, as of :func:`irsim.benchmark`; the files do not depend on it either.
        progress: Callback ``(episodes_done, episodes_total)``.
        limits: Limits of the loader and of each run.
        finish: Called with the result and the folder before another process may work there, to write a report.

    Returns:
        The result; a :class:`irsim.results.benchmark.SuiteResult` of a suite.

    Raises:
        RunError: The folder holds episodes already and ``resume`` is not given, or episodes of another plan; or it
            cannot be written, or another process is running a benchmark there.
        Others: as :func:`irsim.benchmark`.
    """
    _make(folder)
    with _alone_in(folder):
        _prepare(plan, folder, resume)
        timing: dict[str, Any] = {}
        result = measure_plan(
            plan,
            workers=workers,
            cluster=cluster,
            limits=limits,
            progress=progress,
            log=folder / EPISODES,
            resume=resume,
            timing=timing,
        )
        if was_timed(timing) or not (folder / TIMING).exists():  # nothing new keeps the times of the first run
            _write(folder / TIMING, json.dumps(timing, indent=1) + "\n")
        _write(folder / EPISODES, in_order(folder / EPISODES, result.episodes))
        _write(folder / RESULTS, result.model_dump_json(indent=1) + "\n")
        if finish is not None:
            finish(result, folder)
    return result


def measure_plan(plan: Plan, **options: Any) -> BenchmarkResult:
    """Run a plan; it is written nowhere.

    Args:
        plan: The plan.
        **options: ``workers``, ``cluster``, ``limits``, ``progress``, ``log``, ``resume`` and ``timing`` of
            :func:`irsim.benchmark`.

    Returns:
        The result; a :class:`irsim.results.benchmark.SuiteResult` of a suite.

    Raises:
        Others: as :func:`irsim.benchmark`.
    """
    return result_of_plan(plan, benchmark(**_arguments(plan), **options))


def result_of_episodes(plan: Plan, episodes: Iterable[EpisodeRow]) -> BenchmarkResult:
    """The result of a plan whose episodes are known: nothing is run.

    Args:
        plan: The plan.
        episodes: At least its episodes, in any order.

    Raises:
        RunError: An episode is missing.
        Others: as :func:`irsim.benchmark`.
    """
    prepared = prepare_plan(plan)
    known = {(one.scenario, one.behavior, one.seed): one for one in episodes}
    wanted = [(scenario, behavior, task.seed) for scenario, behavior, task in prepared.plan]
    for scenario, behavior, seed in wanted:
        if (scenario, behavior, seed) not in known:
            raise unreadable(f"the episode of {scenario}, {behavior}, seed {seed} is missing")
    return result_of_plan(plan, with_episodes(prepared.head, [known[key] for key in wanted]))


def prepare_plan(plan: Plan) -> Prepared:
    """A plan before its first episode."""
    return prepare(**_arguments(plan))


def _arguments(plan: Plan) -> dict[str, Any]:
    """The arguments of :func:`irsim.benchmark` that a plan has."""
    return {
        "files": {scenario.name: scenario.document() for scenario in plan.scenarios},
        "policies": plan.opened(),
        "seeds": plan.seeds,
        "perturb": plan.perturb,
        "steps": plan.steps,
        "strict": plan.strict,
        "imports": plan.imports,
        "until": plan.until,
        "groups": plan.groups,
        "parts": plan.parts(),
    }


def resume_benchmark(
    folder: Path,
    *,
    workers: int | None = None,
    cluster: str | None = None,
    progress: Progress | None = None,
    limits: Limits | None = None,
    finish: Callable[[BenchmarkResult, Path], object] | None = None,
) -> BenchmarkResult:
    """Go on with an interrupted benchmark, with nothing but what its folder holds; see :func:`run_plan`.

    Raises:
        RunError: The folder holds no plan, or one of another version; or a map file has changed since.
    """
    plan = read_plan(folder)
    if plan.version != version():
        raise RunError(
            "other-benchmark",
            f"{folder} was started by irsim {plan.version}, and this is irsim {version()}",
            "start it again in another folder: results of different versions do not mix",
        )
    changed = map_hashes([scenario.document() for scenario in plan.scenarios])
    for scenario, maps in zip(plan.scenarios, changed, strict=True):
        if maps != scenario.maps:
            name = next((name for name in scenario.maps if maps.get(name) != scenario.maps[name]), "a map")
            raise RunError(
                "other-benchmark",
                f"{name} of the scenario {scenario.name} has changed since {folder} was started",
                "restore the file, or start again in another folder",
            )
    return run_plan(
        plan, folder, resume=True, workers=workers, cluster=cluster, progress=progress, limits=limits, finish=finish
    )


def read_plan(folder: Path) -> Plan:
    """The plan of a benchmark, with nothing but what its folder holds.

    Raises:
        RunError: The folder holds no plan.
    """
    try:
        return Plan.model_validate(read_json(folder / PLAN), strict=False)
    except (ContentError, ValidationError):
        raise RunError("no-benchmark", f"{folder} holds no benchmark that can be resumed", "start it again") from None


def _make(folder: Path) -> None:
    """Make the folder."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        code = code_of(error, "not-writable")
        raise RunError(code, f"{folder}: {error.strerror}", "give another folder with -o") from None


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """Keep other processes from running a benchmark in the folder; the lock ends with this process, however it ends.

    There is no protection on systems and file systems without locks.
    """
    try:
        import fcntl
    except ImportError:
        yield
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            what = f"another process is running the benchmark in {folder}"
            raise RunError("benchmark-running", what, "wait for its end, or give another folder with -o") from None
        except OSError:
            pass
        yield
    finally:
        os.close(descriptor)


def _prepare(plan: Plan, folder: Path, resume: bool) -> None:
    """Write the plan, and delete what a killed process has left half written.

    Raises:
        RunError: See :func:`run_plan`.
    """
    known = folder / PLAN
    try:
        text = plan.model_dump_json(indent=1) + "\n"
    except PydanticSerializationError:
        what = "the name of a scenario or policy is not text in UTF-8, so that the benchmark could not be resumed"
        raise RunError("bad-argument", what, "rename it, or leave out -o") from None
    if not resume and _has_episodes(folder / EPISODES):
        raise RunError("results-exist", f"{folder} holds episodes already", "give --resume, or another folder with -o")
    if known.exists() and (not known.is_file() or known.read_bytes() != text.encode()):
        raise RunError("other-benchmark", f"{folder} holds another benchmark", "give another folder with -o")
    if not known.exists():
        date_now(_plans())
        _write(known, text)
    for leftover in (*folder.glob(f"{TEMPORARY}*"), *folder.glob(f"*/{TEMPORARY}*")):
        with suppress(OSError):
            leftover.unlink()


def _has_episodes(log: Path) -> bool:
    """Whether a log holds more than its head, which is all that a run without a cluster to run on has written."""
    try:
        return log.read_bytes().count(b"\n") > 1
    except FileNotFoundError:
        return False


def _write(path: Path, text: str) -> None:
    try:
        write_atomically(path, text)
    except OSError as error:
        what = f"{path} cannot be written: {error.strerror}"
        raise RunError(code_of(error, "not-writable"), what, "make room, then give --resume") from None


def result_of_plan(plan: Plan, result: BenchmarkResult) -> BenchmarkResult:
    """The result of a plan, with what its suite says."""
    fields: dict[str, Any] = {name: getattr(result, name) for name in BenchmarkResult.model_fields}
    fields["reproduce"] = plan.reproduce or result.reproduce
    if plan.suite is None:
        return BenchmarkResult(**fields)
    own: Mapping[str, Any] = {
        "suite": plan.suite.suite,
        "suite_version": plan.suite.version,
        "title": plan.suite.title,
        "about": plan.suite.about,
        "sources": list(plan.suite.sources),
        "steps": plan.suite.steps,
        "seconds": plan.suite.seconds,
        "until": plan.suite.until,
        "suite_hash": plan.suite_hash,
        "hash": plan.hash,
        "policies": plan.policies,
        "facts": [
            SuiteScenarioFacts(name=one.name, family=one.family, protocol=one.protocol, values=one.values)
            for one in plan.scenarios
        ],
    }
    return SuiteResult(**fields, **own)
