"""Run many episodes on all cores; results come in the order of the tasks."""

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

_START_DELAY_S = 0.7
"""Time [s] after which further processes are started; most benchmarks of a few episodes end before."""


def cores() -> int:
    """Number of cores that this process may use."""
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
    """Run episodes in this process and, if that takes longer than a moment, in further processes.

    A task that a further process cannot run (with a behavior that only this program has registered) is run here.

    Args:
        tasks: The tasks.
        workers: Greatest number of processes, including this one.
        progress: Callback ``(episodes_done, episodes_total)``, called in this thread.
        kept: Callback ``(number_of_the_task, result)``, called for each result, in any thread.

    Returns:
        The results, in the order of the tasks.

    Raises:
        IrsimError: The first error of an episode, in the order of the tasks.
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
            late = time.monotonic() - begin > _START_DELAY_S
            if late and not helpers and workers > 1 and shared.left() > 1:
                helpers = [_Helper(shared) for _ in range(min(workers - 1, shared.left()))]
            if progress is not None:
                progress(shared.done(), len(tasks))
    finally:
        for helper in helpers:
            helper.end()
    return [shared.results[index] for index in range(len(tasks))]


class _Shared:
    """The remaining tasks and the results, shared by the threads."""

    def __init__(self, tasks: Sequence[Task], kept: Callable[[int, dict[str, Any]], None] | None) -> None:
        self.tasks, self._kept = tasks, kept
        self.results: dict[int, dict[str, Any]] = {}
        self._open = deque(range(len(tasks)))
        self._mine: deque[int] = deque()  # tasks that only this process can run
        self._out = 0
        self._changed = threading.Condition()

    def take(self, *, elsewhere: bool = False) -> int | None:
        """Take the next task; None if there is none at present.

        Args:
            elsewhere: The task is for another process.
        """
        with self._changed:
            queue = self._mine if self._mine and not elsewhere else self._open
            if not queue:
                return None
            self._out += 1
            return queue.popleft()

    def put(self, index: int, result: dict[str, Any]) -> None:
        """Store the result of a task; the callback gets it before the task counts as done."""
        if self._kept is not None:
            self._kept(index, result)
        self.results[index] = result

    def leave(self, *, back: int | None = None) -> None:
        """Give a task back.

        Args:
            back: The task, if it has no result and the main thread must run it.
        """
        with self._changed:
            self._out -= 1
            if back is not None:
                self._mine = deque(sorted([*self._mine, back]))
            self._changed.notify_all()

    def stop(self, index: int) -> None:
        """Keep only the tasks before one that failed, and then that task again, so that its error is the first."""
        with self._changed:
            earlier = [one for one in (*self._mine, *self._open) if one < index]
            self._mine, self._open = deque([*earlier, index]), deque()

    def is_first(self, index: int) -> bool:
        """Whether all tasks before one are done."""
        with self._changed:
            return all(one in self.results for one in range(index))

    def busy(self) -> bool:
        """Whether a task is being run."""
        with self._changed:
            return self._out > 0 or bool(self._mine)

    def wait(self) -> None:
        """Wait until a task ends, but not for long."""
        with self._changed:
            if self._out and not self._mine:
                self._changed.wait(0.2)

    def left(self) -> int:
        with self._changed:
            return len(self._open)

    def done(self) -> int:
        return len(self.results)


class _Helper:
    """A further process, and the thread that sends tasks to it."""

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
        """Stop the process immediately."""
        self._process.kill()
        self._thread.join()
        for pipe in (self._process.stdin, self._process.stdout):
            with suppress(OSError):
                pipe.close()  # type: ignore[union-attr]
        self._process.wait()
