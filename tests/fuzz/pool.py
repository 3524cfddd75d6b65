"""Processes that try documents; one that dies takes only the document along that killed it."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
from collections import Counter
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from tests.fuzz.attempt import SECONDS

__all__ = ["Tally", "Wrong", "try_all"]

ROOT = Path(__file__).resolve().parents[2]
_RENEWED = 500
"""Documents after which a process makes room for a new one: memory of many adds up to none."""


@dataclass(frozen=True)
class Wrong:
    """A document that should have been answered otherwise."""

    index: int
    text: str
    what: str


@dataclass
class Tally:
    """Results of all documents."""

    came_to: Counter[str] = field(default_factory=Counter)
    wrong: list[Wrong] = field(default_factory=list)
    slowest: tuple[float, int] = (0.0, -1)


def try_all(documents: Iterable[tuple[int, str]], *, workers: int = 2) -> Tally:
    """Load, validate and run documents.

    Args:
        documents: (number, text).
        workers: Processes at a time.
    """
    tally, lock, rest = Tally(), threading.Lock(), iter(documents)

    def take() -> tuple[int, str] | None:
        with lock:
            return next(rest, None)

    def work() -> None:
        for index, text, answer in _answers(iter(take, None)):
            with lock:
                tally.came_to[str(answer["came_to"])] += 1
                tally.slowest = max(tally.slowest, (float(str(answer["seconds"])), index))
                if answer["wrong"] is not None:
                    tally.wrong.append(Wrong(index, text, str(answer["wrong"])))

    with ThreadPoolExecutor(workers) as threads:
        for done in [threads.submit(work) for _ in range(workers)]:
            done.result()
    tally.wrong.sort(key=lambda wrong: wrong.index)
    return tally


def _answers(documents: Iterator[tuple[int, str]]) -> Iterator[tuple[int, str, dict[str, object]]]:
    process, done = _started(), 0
    try:
        for index, text in documents:
            if done >= _RENEWED:
                _end(process)
                process, done = _started(), 0
            answer = _asked(process, index, text)
            done += 1
            if "died" in answer:
                _end(process)
                process, done = _started(), 0
            yield index, text, answer
    finally:
        _end(process)


def _asked(process: subprocess.Popen[str], index: int, text: str) -> dict[str, object]:
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        process.stdin.write(json.dumps({"index": index, "text": text}) + "\n")
        process.stdin.flush()
        line = process.stdout.readline()
    except OSError:
        line = ""
    if line:
        return dict(json.loads(line))
    code = process.wait()
    known = {-signal.SIGPROF: f"more than {SECONDS:g} s of computing", -signal.SIGALRM: "it hangs"}
    what = known.get(code, f"the process ended with code {code}")
    return {"came_to": "died", "died": True, "wrong": what, "seconds": 0.0}


def _started() -> subprocess.Popen[str]:
    single = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
    return subprocess.Popen(
        [sys.executable, "-m", "tests.fuzz.attempt"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        env={**os.environ, **single},
    )


def _end(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.wait()
    for pipe in (process.stdin, process.stdout):
        if pipe is not None:
            with contextlib.suppress(OSError):
                pipe.close()
