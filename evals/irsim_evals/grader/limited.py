"""Grading in a process of its own with limits of memory, time and files: an answer is untrusted input.

Time is processor time, so that a verdict does not depend on what else the machine does; the clock ends only what hangs,
and everything where the system cannot count processor time.

Processes are forked from a server that has imported the grader, so that each costs milliseconds. Where the system
cannot fork, each is started anew.
"""

from __future__ import annotations

import itertools
import multiprocessing
import os
import pkgutil
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import irsim.components
from irsim.common.child import how_ended, limit
from irsim_evals.cases.store import Instance
from irsim_evals.grader.artefact import CALLS_FILE, Answer, ArtefactError, calls_of, cost_of, from_folder
from irsim_evals.grader.outcome import Verdict

__all__ = [
    "SECONDS", "LimitError", "Worker", "grade_all", "grade_answer", "grade_folder", "preload", "run_all", "run_limited",
]  # fmt: skip

SECONDS = 60.0
"""Processor time [s] after which the grading of one answer is ended."""
_PATIENCE = 10.0
"""Time on the clock after which a job is ended, as a multiple of its processor time."""
_PROGRAM_SECONDS = 300.0
"""The same where commands may run programs of the answer."""
_MEMORY_BYTES = 6 * 1024**3
"""Address space of a grading process."""
_FILE_BYTES = 64 * 1024**2
"""Size of a file that a grading process may write."""


class LimitError(RuntimeError):
    """A limited process took too long, or ended without a result: nothing is known of what it would have returned."""


def grade_answer(instance: Instance, answer: Answer, seconds: float = SECONDS) -> Verdict:
    """Grade an answer in a limited process; a process that dies or takes too long is a failed verdict."""
    try:
        return Verdict.model_validate(run_limited(_grade, (instance, answer), seconds, "grading"))
    except LimitError as error:
        return _failed(instance, answer, str(error))


def run_limited(work: Callable[..., Any], arguments: tuple[Any, ...], seconds: float, what: str) -> Any:
    """Call a function in a process with limits of memory, time and files, and without the network.

    Args:
        work: Function of a module; what it takes and returns can be pickled.
        arguments: Its arguments.
        seconds: Processor time after which the process is ended [s].
        what: Its task in words, for the message.

    Raises:
        LimitError: The process took too long, or ended without a result.
    """
    worker = Worker(cpu_seconds=int(seconds) + 5)
    try:
        return worker.call(work, arguments, seconds, what)
    finally:
        worker.close()


def grade_folder(instance: Instance, folder: Path, calls: Path | None = None, run_programs: bool = False) -> Verdict:
    """Grade what an agent left in a folder, and read what it cost.

    Args:
        instance: The case.
        folder: The folder.
        calls: File that ``irsim-mcp --log-calls`` wrote; default: ``calls.jsonl`` in the folder.
        run_programs: Whether commands of the case may run programs of the answer, with the rights of this process.
    """
    try:
        answer = from_folder(folder, turns=len(instance.requests))
        answer = replace(answer, calls=calls_of(calls or folder / CALLS_FILE)[0])
    except (ArtefactError, OSError) as error:
        verdict = _failed(instance, None, str(error))
    else:
        if run_programs:
            answer = replace(answer, trusted_folder=folder.resolve())
        verdict = grade_answer(instance, answer, _PROGRAM_SECONDS if run_programs else SECONDS)
    verdict.cost = cost_of(calls or folder / CALLS_FILE)
    return verdict


def grade_all(pairs: Iterable[tuple[Instance, Answer]]) -> Iterator[Verdict]:
    """Grade many answers, as many at a time as there are processors; verdicts come in the order of the answers.

    A process grades one answer after the other, and a new one takes its place if it dies or takes too long.
    """
    given, to_grade = itertools.tee(pairs)
    for (instance, answer), result in zip(given, run_all(_grade, to_grade, None, SECONDS, "grading"), strict=True):
        yield (
            _failed(instance, answer, str(result)) if isinstance(result, LimitError) else Verdict.model_validate(result)
        )


def run_all(
    work: Callable[..., Any], jobs: Iterable[tuple[Any, ...]], workers: int | None, seconds: float, what: str
) -> Iterator[Any]:
    """Call a function for each tuple of arguments in limited processes; see :func:`run_limited`.

    A process does one job after the other, and a new one takes its place if it dies or takes too long.

    Returns:
        Its results in the order of the jobs; a :class:`LimitError` in place of one that is missing.
    """
    count = workers or os.cpu_count() or 1
    idle: SimpleQueue[Worker] = SimpleQueue()
    crew = [Worker() for _ in range(count)]
    for worker in crew:
        idle.put(worker)

    def one(job: tuple[Any, ...]) -> Any:
        worker = idle.get()
        try:
            return worker.call(work, job, seconds, what)
        except LimitError as error:
            return error
        finally:
            idle.put(worker)

    try:
        with ThreadPoolExecutor(count) as pool:
            yield from pool.map(one, jobs)
    finally:
        for worker in crew:
            worker.close()


class Worker:
    """A limited process that does jobs; it is started when it is needed first, and again after it has been ended.

    Args:
        cpu_seconds: Processor time that the process gets; None for no limit.
    """

    def __init__(self, cpu_seconds: int | None = None) -> None:
        self._cpu_seconds = cpu_seconds
        self._process: Any = None
        self._pipe: Any = None

    def call(self, work: Callable[..., Any], arguments: tuple[Any, ...], seconds: float, what: str) -> Any:
        """Call a function there.

        Raises:
            LimitError: The process took too long, or ended without a result; it has been ended.
        """
        if self._process is None:
            self._start()
        try:
            self._pipe.send((work, arguments, seconds))
            if self._pipe.poll(_PATIENCE * seconds):
                return self._pipe.recv()
            why = f"the {what} took more than {_PATIENCE * seconds:g} s on the clock"
        except (EOFError, OSError):
            why = f"the {what} process ended with {_exit(self._process)}"
            if self._process.exitcode == -getattr(signal, "SIGPROF", 0):
                why = f"the {what} took more than {seconds:g} s of processor time"
        self.close()
        raise LimitError(why)

    def close(self) -> None:
        """End the process."""
        if self._process is None:
            return
        self._pipe.close()
        self._process.kill()
        self._process.join()
        self._process = None

    def _start(self) -> None:
        context = _context()
        self._pipe, there = context.Pipe()
        process = context.Process(target=_do_jobs, args=(there, self._cpu_seconds), daemon=True)
        process.start()  # a process that did not start cannot be ended
        self._process = process
        there.close()


def preload(*modules: str) -> None:
    """Import modules once for all limited processes that are started after the first call; call it before that."""
    _preloaded.extend(name for name in modules if name not in _preloaded)


_preloaded = [
    "matplotlib.colors", "shapely.affinity", "irsim.env", "irsim.validation.diff.compare", "irsim_evals.grader.grade",
]  # fmt: skip
"""Modules that gradings import."""


def _context() -> Any:
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    components = pkgutil.walk_packages(irsim.components.__path__, "irsim.components.")
    context.set_forkserver_preload([*_preloaded, *(module.name for module in components)])
    return context


def _do_jobs(there: Connection, cpu_seconds: int | None) -> None:
    """Do jobs until there are no more; runs in the limited process, which its parent ends after Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _limit(cpu_seconds)
    with suppress(EOFError, BrokenPipeError):
        while True:
            work, arguments, seconds = there.recv()
            _allow(seconds)
            result = work(*arguments)
            _allow(0.0)
            there.send(result)


def _allow(seconds: float) -> None:
    """Let the system end this process, wherever it is, after so much processor time from now on; 0: never."""
    if hasattr(signal, "ITIMER_PROF"):
        signal.setitimer(signal.ITIMER_PROF, seconds)  # nothing handles its signal


def _grade(instance: Instance, answer: Answer) -> Any:
    from irsim_evals.grader.grade import grade

    return grade(instance, answer).model_dump(mode="json")


def _limit(cpu_seconds: int | None) -> None:
    """Limit memory, processor time and files of this process, and take away the network."""
    import socket

    def refuse(*_: Any, **__: Any) -> Any:
        raise OSError("the grader has no network")

    socket.socket = refuse  # type: ignore[assignment, misc]
    sys.stdin = open(os.devnull)  # noqa: SIM115
    limit(memory=_MEMORY_BYTES, written=_FILE_BYTES, cpu=cpu_seconds)


def _failed(instance: Instance, answer: Answer | None, observed: str) -> Verdict:
    from irsim_evals.grader.grade import failed_verdict

    return failed_verdict(instance, answer, "gradable", "parse", observed)


def _exit(process: Any) -> str:
    process.join(1.0)
    return "no result" if process.exitcode in (0, None) else how_ended(process.exitcode)
