"""Grading in a process of its own with limits of memory, time and files: an answer is somebody else's work.

Processes are forked from a server that has imported the grader, so that each costs milliseconds. Where the system
cannot fork, each is started anew.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from irsim_evals.cases.instance import Instance
from irsim_evals.cases.store import Answer
from irsim_evals.grader.artefact import ArtefactError, from_folder
from irsim_evals.grader.outcome import Verdict

__all__ = ["SECONDS", "grade_all", "grade_answer", "grade_folder"]

SECONDS = 60.0
"""Time [s] after which the grading of one answer is ended."""
_MEMORY_BYTES = 6 * 1024**3
"""Address space of a grading process."""
_FILE_BYTES = 64 * 1024**2
"""Size of a file that a grading process may write."""


def grade_answer(instance: Instance, answer: Answer, seconds: float = SECONDS) -> Verdict:
    """Grade an answer in a limited process; a process that dies or takes too long is a failed verdict."""
    context = _context()
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_work, args=(there, instance, answer, seconds), daemon=True)
    process.start()
    there.close()
    try:
        if here.poll(seconds):
            with suppress(EOFError):
                return Verdict.model_validate(here.recv())
            return _failed(instance, answer, f"the grading process ended with {_exit(process)}")
        return _failed(instance, answer, f"the grading took more than {seconds:g} s")
    finally:
        here.close()
        if process.is_alive():
            process.kill()
        process.join()


def grade_folder(instance: Instance, folder: Path, seconds: float = SECONDS) -> Verdict:
    """Grade what an agent left in a folder."""
    try:
        answer = from_folder(folder)
    except (ArtefactError, OSError) as error:
        return _failed(instance, None, str(error))
    return grade_answer(instance, answer, seconds)


def grade_all(
    pairs: Iterable[tuple[Instance, Answer]], workers: int | None = None, seconds: float = SECONDS
) -> Iterator[Verdict]:
    """Grade many answers, as many at a time as there are processors; verdicts come in the order of the answers."""
    with ThreadPoolExecutor(workers or os.cpu_count() or 1) as pool:
        yield from pool.map(lambda pair: grade_answer(pair[0], pair[1], seconds), pairs)


def _context() -> Any:
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["irsim_evals.grader.grade", "irsim.env", "shapely.affinity"])
    return context


def _work(there: Connection, instance: Instance, answer: Answer, seconds: float) -> None:
    """Grade one answer; runs in the limited process."""
    _limit(seconds)
    from irsim_evals.grader.grade import grade

    there.send(grade(instance, answer).model_dump(mode="json"))
    there.close()


def _limit(seconds: float) -> None:
    """Limit memory, processor time and files of this process, and take away the network."""
    import socket

    def refuse(*_: Any, **__: Any) -> Any:
        raise OSError("the grader has no network")

    socket.socket = refuse  # type: ignore[assignment, misc]
    sys.stdin = open(os.devnull)  # noqa: SIM115
    if os.name != "nt":
        import resource

        cpu = int(seconds) + 5
        for what, most in (
            (resource.RLIMIT_AS, _MEMORY_BYTES),
            (resource.RLIMIT_CPU, cpu),
            (resource.RLIMIT_FSIZE, _FILE_BYTES),
            (resource.RLIMIT_CORE, 0),
        ):
            with suppress(ValueError, OSError):
                resource.setrlimit(what, (most, most))


def _failed(instance: Instance, answer: Answer | None, observed: str) -> Verdict:
    from irsim_evals.grader.grade import failed_verdict

    return failed_verdict(instance, answer, "gradable", "parse", observed)


def _exit(process: Any) -> str:
    process.join(1.0)
    return "no result" if process.exitcode in (0, None) else f"exit code {process.exitcode}"
