"""Many episodes on all cores, the results in the order of the tasks whoever computed them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

from irsim.benchmarks.episode import Task, run_task

__all__ = ["cores", "run_tasks"]

_PATIENCE = 0.7
"""Seconds of work after which other processes are started; most benchmarks of a few episodes are over by then."""


def cores() -> int:
    """Cores this process may use."""
    with suppress(AttributeError, OSError):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def run_tasks(
    tasks: Sequence[Task],
    *,
    workers: int,
    progress: Callable[[int, int], None] | None = None,
    kept: Callable[[int, dict[str, Any]], None] | None = None,
) -> list[dict[str, Any]]:
    """Run episodes, here and, if it takes longer than a moment, in further processes.

    What a process cannot do (a behavior that only this program has registered) is done here.

    Args:
        tasks: In the order of the results.
        workers: Processes at most, this one included.
        progress: Told (episodes done, episodes) in this thread.
        kept: Given the number of a task and its result as soon as there is one, in any thread.

    Raises:
        IrsimError: What an episode raised; the first in the order of the tasks.
    """
    shared = _Shared(tasks, kept)
    helpers: list[_Helper] = []
    begin = time.monotonic()
    try:
        while (index := shared.take()) is not None or shared.busy():
            if index is None:
                shared.wait()
            else:
                try:
                    shared.put(index, run_task(tasks[index]))
                except Exception:
                    shared.stop(index)
                    if shared.is_first(index):
                        raise
                    continue
                finally:
                    shared.leave()
            late = time.monotonic() - begin > _PATIENCE
            if late and not helpers and workers > 1 and shared.left() > 1:
                helpers = [_Helper(shared) for _ in range(min(workers - 1, shared.left()))]
            if progress is not None:
                progress(shared.done(), len(tasks))
    finally:
        for helper in helpers:
            helper.end()
    return [shared.results[index] for index in range(len(tasks))]


class _Shared:
    """What is left to do, and the results."""

    def __init__(self, tasks: Sequence[Task], kept: Callable[[int, dict[str, Any]], None] | None) -> None:
        self.tasks, self._kept = tasks, kept
        self.results: dict[int, dict[str, Any]] = {}
        self._open = deque(range(len(tasks)))
        self._mine: deque[int] = deque()  # what others could not do
        self._out = 0
        self._changed = threading.Condition()

    def take(self, *, elsewhere: bool = False) -> int | None:
        """The next task; None if there is none at present."""
        with self._changed:
            queue = self._mine if self._mine and not elsewhere else self._open
            if not queue:
                return None
            self._out += 1
            return queue.popleft()

    def put(self, index: int, result: dict[str, Any]) -> None:
        """One has a result; it is kept before it counts as done."""
        if self._kept is not None:
            self._kept(index, result)
        self.results[index] = result

    def leave(self, *, back: int | None = None) -> None:
        """One is done; ``back``: it has to be done by the main thread."""
        with self._changed:
            self._out -= 1
            if back is not None:
                self._mine = deque(sorted([*self._mine, back]))
            self._changed.notify_all()

    def stop(self, index: int) -> None:
        """Hand out only what comes before a task that failed, and then that once more."""
        with self._changed:
            earlier = [one for one in (*self._mine, *self._open) if one < index]
            self._mine, self._open = deque([*earlier, index]), deque()

    def is_first(self, index: int) -> bool:
        """Whether everything before a task is done."""
        with self._changed:
            return all(one in self.results for one in range(index))

    def busy(self) -> bool:
        """Whether somebody is at work."""
        with self._changed:
            return self._out > 0 or bool(self._mine)

    def wait(self) -> None:
        """Until something has changed."""
        with self._changed:
            if self._out and not self._mine:
                self._changed.wait(0.2)

    def left(self) -> int:
        with self._changed:
            return len(self._open)

    def done(self) -> int:
        return len(self.results)


class _Helper:
    """A process and the thread that feeds it."""

    def __init__(self, shared: _Shared) -> None:
        self._shared = shared
        isolated = ["-I"] if sys.flags.isolated else []
        start = f"import sys; sys.path[:] = {sys.path!r}; from irsim.benchmarks.worker import main; main()"
        self._process = subprocess.Popen(
            [sys.executable, *isolated, "-X", "utf8", "-c", start],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        )
        self._thread = threading.Thread(target=self._feed, daemon=True)
        self._thread.start()

    def _feed(self) -> None:
        shared = self._shared
        while (index := shared.take(elsewhere=True)) is not None:
            answer = self._answer(shared.tasks[index])
            if answer is None or "result" not in answer:
                shared.leave(back=index)
                return
            shared.put(index, answer["result"])
            shared.leave()

    def _answer(self, task: Task) -> dict[str, Any] | None:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(json.dumps(task.as_data()).encode() + b"\n")
            self._process.stdin.flush()
            return dict(json.loads(self._process.stdout.readline()))
        except (OSError, ValueError):
            return None

    def end(self) -> None:
        """Stop at once."""
        self._process.kill()
        self._thread.join()
        for pipe in (self._process.stdin, self._process.stdout):
            with suppress(OSError):
                pipe.close()  # type: ignore[union-attr]
        self._process.wait()
