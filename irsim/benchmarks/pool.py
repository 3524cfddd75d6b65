"""Run many episodes on all cores; results come in the order of the tasks."""

from __future__ import annotations

import json
import os
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict
from typing import Any

from irsim.benchmarks.controlled import ControllerJob
from irsim.benchmarks.episode import Job, Task
from irsim.benchmarks.together import run_together
from irsim.common.child import ONE_THREAD, Child, answers, lines, python, write_line
from irsim.diagnostics.errors import WorkerError

__all__ = ["MAX_DEATHS", "READY", "WorkerError", "cores", "dead_workers", "main", "run_tasks"]

_START_DELAY_S = 0.7
"""Time [s] after which further processes are started; most benchmarks of a few episodes end before."""
MAX_DEATHS = 3
"""Number of processes that may die while they run the same episode."""
MAX_GROUP = 25
"""Number of episodes of one job that a process takes at once."""
READY = b"ready\n"
"""The first line of a further process, which says that tasks can be sent."""


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

    Each process takes a few tasks with the same job and runs them together. A task that a further process cannot run
    (with a behavior that only this program has registered) is run here. A process that dies is replaced, and its tasks
    are run again.

    Args:
        tasks: The tasks.
        workers: Greatest number of processes, including this one.
        progress: Callback ``(episodes_done, episodes_total)``, called in this thread.
        kept: Callback ``(number_of_the_task, result)``, called for each result, in any thread.

    Returns:
        The results, in the order of the tasks.

    Raises:
        IrsimError: The first error of an episode, in the order of the tasks.
        WorkerError: Several processes have died in the same episode.
    """
    shared = _Shared(tasks, kept, workers)
    helpers: list[_Helper] = []
    begin = time.monotonic()

    def done_here(index: int, result: dict[str, Any]) -> None:
        nonlocal helpers
        shared.put(index, result)
        late = time.monotonic() - begin > _START_DELAY_S
        if late and not helpers and workers > 1 and shared.left() > 1:
            number = min(workers - 1, shared.left())
            shared.join(number)
            helpers = [_Helper(shared) for _ in range(number)]
        if progress is not None:
            progress(shared.done(), len(tasks))

    try:
        while (group := shared.take()) or shared.busy():
            if group:
                _run_here(shared, group, done_here)
            else:
                shared.wait()
                if progress is not None:
                    progress(shared.done(), len(tasks))
    finally:
        for helper in helpers:
            helper.end()
    return [shared.results[index] for index in range(len(tasks))]


def _run_here(shared: _Shared, group: list[int], done: Callable[[int, dict[str, Any]], None]) -> None:
    """Run a group in this process. If it fails, its remaining tasks are run one by one, which shows the one at fault.

    Raises:
        IrsimError: The group is a single task, the first one that fails.
    """
    rest = list(group)
    results = run_together(shared.tasks[group[0]].job, [shared.tasks[index].seed for index in group])
    try:
        while rest:
            try:
                shared.check(group[0])
                result = next(results)
            except Exception:
                if len(group) > 1:
                    shared.back(rest)
                    return
                shared.stop(group[0])
                if shared.is_first(group[0]):
                    raise
                return
            done(rest.pop(0), result)
    finally:
        shared.leave()


class _Shared:
    """The remaining tasks and the results, shared by the threads."""

    def __init__(self, tasks: Sequence[Task], kept: Callable[[int, dict[str, Any]], None] | None, workers: int) -> None:
        self.tasks, self._kept, self._workers = tasks, kept, workers
        self.results: dict[int, dict[str, Any]] = {}
        own = [index for index, task in enumerate(tasks) if task.job.local is not None]
        self._open = deque(index for index, task in enumerate(tasks) if task.job.local is None)
        self._mine: deque[int] = deque(own)  # tasks that only this process can run
        self._risky: deque[int] = deque()  # tasks in which a process has died: another one tries them, not this one
        self._helpers = 0
        self._out = 0
        self._deaths = Counter[int]()
        self._changed = threading.Condition()

    def take(self, *, elsewhere: bool = False) -> list[int]:
        """Take the next tasks, all with the same job; empty if all are taken at present.

        Args:
            elsewhere: The tasks are for another process.
        """
        with self._changed:
            first = self._risky if elsewhere else self._mine
            group = [first.popleft()] if first else self._next_group()
            self._out += bool(group)
            return group

    def _next_group(self) -> list[int]:
        """Remove the next tasks that can run together; few at the end, so that all processes end together."""
        size = max(1, min(MAX_GROUP, len(self._open) // (4 * self._workers)))
        group: list[int] = []
        while self._open and len(group) < size:
            if group and self.tasks[self._open[0]].job is not self.tasks[group[0]].job:
                break
            group.append(self._open.popleft())
        return group

    def put(self, index: int, result: dict[str, Any]) -> None:
        """Store the result of a task; the callback gets it before the task counts as done."""
        if self._kept is not None:
            self._kept(index, result)
        self.results[index] = result

    def leave(self) -> None:
        """Count a group as ended."""
        with self._changed:
            self._out -= 1
            self._changed.notify_all()

    def back(self, tasks: Sequence[int]) -> None:
        """Have tasks without a result run by the main thread, one by one."""
        with self._changed:
            self._mine = deque(sorted([*self._mine, *tasks]))
            self._changed.notify_all()

    def died(self, tasks: Sequence[int]) -> None:
        """Give tasks back whose process has died; another one runs them one by one, after several deaths none.

        Only a single task counts as the cause.
        """
        with self._changed:
            if len(tasks) == 1:
                self._deaths[tasks[0]] += 1
            self._risky.extend(index for index in tasks if self._deaths[index] < MAX_DEATHS)
            self._mine = deque(sorted([*self._mine, *(i for i in tasks if self._deaths[i] >= MAX_DEATHS)]))
            self._out -= 1
            self._changed.notify_all()

    def join(self, helpers: int) -> None:
        """Add helpers, or with a negative number remove ended ones; this process gets the tasks of the last one."""
        with self._changed:
            self._helpers += helpers
            if not self._helpers:
                self._mine = deque(sorted([*self._mine, *self._risky]))
                self._risky.clear()
                self._changed.notify_all()

    def check(self, index: int) -> None:
        """Refuse a task in which several processes have died.

        Raises:
            WorkerError: See there.
        """
        if self._deaths[index] >= MAX_DEATHS:
            raise dead_workers(self.tasks[index])

    def stop(self, index: int) -> None:
        """Keep only the tasks before one that failed, and then that task again, so that its error is the first."""
        with self._changed:
            earlier = [one for one in (*self._mine, *self._risky, *self._open) if one < index]
            self._mine, self._risky, self._open = deque([*earlier, index]), deque(), deque()

    def is_first(self, index: int) -> bool:
        """Whether all tasks before one are done."""
        with self._changed:
            return all(one in self.results for one in range(index))

    def busy(self) -> bool:
        """Whether a task is being run."""
        with self._changed:
            return self._out > 0 or bool(self._mine or self._risky)

    def wait(self) -> None:
        """Wait until a task ends, but not for long."""
        with self._changed:
            if (self._out or self._risky) and not self._mine:
                self._changed.wait(0.2)

    def left(self) -> int:
        with self._changed:
            return len(self._open)

    def done(self) -> int:
        return len(self.results)


def dead_workers(task: Task) -> WorkerError:
    """The error for an episode in which several processes have died."""
    return WorkerError(
        f"{MAX_DEATHS} processes died while they ran {task.job.name}, seed {task.seed}, with {task.job.behavior}",
        "check the memory and your own modules, then go on with --resume",
    )


class _Helper:
    """A further process, which is replaced when it dies, and the thread that sends tasks to it."""

    def __init__(self, shared: _Shared) -> None:
        self._shared = shared
        self._ended = False
        self._lock = threading.Lock()
        self._process = _start()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        try:
            if self._is_ready():
                self._feed(self._shared)
        finally:
            self._shared.join(-1)

    def _feed(self, shared: _Shared) -> None:
        while group := shared.take(elsewhere=True):
            rest = list(group)
            failed = not self._send(shared.tasks[group[0]].job, [shared.tasks[index].seed for index in group])
            while rest and not failed:
                answer = self._receive()
                if answer is not None and "result" in answer:
                    shared.put(rest.pop(0), answer["result"])
                elif answer is None:
                    failed = True
                else:
                    shared.back(rest)
                    shared.leave()
                    return
            if not rest:
                shared.leave()
                continue
            shared.died(rest)
            if not self._replace():
                return

    def _replace(self) -> bool:
        """Start another process in place of one that has died; False if it does not start or is not needed."""
        with self._lock:
            if self._ended:
                return False
            self._process.end()
            self._process = _start()
        return self._is_ready()

    def _is_ready(self) -> bool:
        """Wait until the process can run tasks; False if it cannot be started."""
        return self._process.receive() == READY

    def _send(self, job: Job, seeds: list[int]) -> bool:
        """Send tasks to the process; False if it has died."""
        return self._process.send(json.dumps({"job": asdict(job), "seeds": seeds}).encode())

    def _receive(self) -> dict[str, Any] | None:
        """The next answer of the process; None if it has died."""
        try:
            return dict(json.loads(self._process.receive() or b""))
        except ValueError:
            return None

    def end(self) -> None:
        """Stop the process immediately."""
        with self._lock:
            self._ended = True
            self._process.kill()  # ends the thread's wait for an answer
        self._thread.join()
        self._process.end()


def _start() -> Child:
    return Child(python("irsim.benchmarks.pool"), start_new_session=False, env=os.environ | ONE_THREAD)


def main() -> None:
    """Run tasks in a further process: a job and its seeds per line of standard input, a result per line of output.

    It ends immediately when its standard input is closed, so it never outlives the process that started it.
    """
    pipe, tasks = answers(), lines()
    pipe.write(READY)
    while True:
        data = json.loads(tasks.get())
        try:
            kind = ControllerJob if "controller" in data["job"] else Job
            for result in run_together(kind.of_data(data["job"]), data["seeds"]):
                write_line(pipe, {"result": result})
        except Exception as error:
            write_line(pipe, {"error": f"{type(error).__name__}: {error}"})
