"""Start one program of an answer in its folder, with what it needs to run scenarios and nothing else, or rehearse it.

Run as ``python -I -m irsim_evals.grader.run_program PROGRAM SECONDS [LOG]``, in the folder; SECONDS is its processor
time. With LOG the program is rehearsed:
it simulates nothing, and the episodes that it starts are written to that file. In a rehearsal a step only counts, so
every episode goes on to the horizon that the program has for it, and hundreds of episodes take seconds. A benchmark
runs one episode, whose result stands for all.

The rules of :mod:`irsim_evals.grader.programs` have been checked before; the hook here refuses what they cannot see.
"""

from __future__ import annotations

import atexit
import json
import math
import os
import runpy
import sys
import time
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from irsim.common.child import limit

__all__ = ["Started", "read_log", "rehearse"]

_WATCHED = 8
"""Number of simulations whose steps are followed at the same time; a program steps the newest ones."""
_REFUSED = ("socket.connect", "socket.bind", "socket.getaddrinfo", "os.system", "os.exec",
            "os.remove", "os.rename", "os.rmdir", "os.symlink", "os.link", "os.chmod", "os.chown", "ctypes.dlopen",
            "shutil.rmtree", "webbrowser.open", "urllib.Request")  # fmt: skip
_WRITE = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_PYTHON = os.path.realpath(sys.executable)


@dataclass(frozen=True)
class Started:
    """One episode that a program has started or planned.

    Attributes:
        file: Path of the scenario, relative to the folder of the answer; empty for a text.
        behaviors: Names of the behaviors of its robots.
        seed: Its seed.
        steps: Number of steps of the episode if no robot arrives; None where only the scenario ends it, and it does not
            say when.
    """

    file: str
    behaviors: tuple[str, ...]
    seed: int
    steps: int | None


def read_log(path: Path) -> list[Started]:
    """The episodes in the order in which they were started; without a file there are no episodes."""
    if not path.is_file():
        return []
    episodes: dict[Any, Started] = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines()):
        try:
            data = json.loads(line)
        except ValueError:  # the process was ended while it wrote
            continue
        key = data.pop("key") or number
        episodes[str(key)] = Started(**{**data, "behaviors": tuple(data["behaviors"])})
    return list(episodes.values())


def rehearse(path: Path) -> None:
    """Simulate nothing from now on, and write down which episodes this process starts: a benchmark's when they are
    planned, others when the next one begins and at the end of the process."""
    from irsim.benchmarks import comparison
    from irsim.simulation.simulation import Simulation

    log = _Log(path)
    planner: Any = comparison
    plain_tasks, plain_init, plain_reset = planner.run_tasks, Simulation.__init__, Simulation.reset

    def run_tasks(tasks: Sequence[Any], *, workers: int, progress: Any = None, kept: Any = None) -> Any:
        log.plan(tasks)
        try:
            [one] = plain_tasks(tasks[:1], workers=1)
        finally:
            log.planned = False
        for number in range(len(tasks)):
            if kept is not None:
                kept(number, one)
        return [one] * len(tasks)

    def init(self: Any, *arguments: Any, **options: Any) -> None:
        log.write()
        plain_init(self, *arguments, **options)
        log.follow(self)

    def reset(self: Any, *arguments: Any, **options: Any) -> None:
        log.write()
        plain_reset(self, *arguments, **options)

    def step(self: Any) -> None:
        self.count += 1

    def advance(self: Any, steps: int, *, until_done: bool = False) -> int:
        self.count += steps
        return steps

    planner.run_tasks = run_tasks
    Simulation.step = step  # type: ignore[method-assign]
    Simulation.advance = advance  # type: ignore[method-assign]
    Simulation.in_python = property(lambda _: True)  # type: ignore[method-assign, assignment]
    Simulation.__init__ = init  # type: ignore[method-assign]
    Simulation.reset = reset  # type: ignore[method-assign]
    atexit.register(log.write)


class _Log:
    """The file, and the simulations whose steps are still to be written."""

    def __init__(self, path: Path) -> None:
        self.file = path.open("a", encoding="utf-8")
        self.running: deque[Any] = deque(maxlen=_WATCHED)
        self.written: dict[str, int] = {}
        self.count = 0
        self.planned = False

    def plan(self, tasks: Sequence[Any]) -> None:
        """Write the episodes of a benchmark, whose simulations are then not followed."""
        from irsim.benchmarks.episode import scenario_of

        self.planned = True
        for task in tasks:
            scenario = scenario_of(task.job)
            self._add("", task.job.path, scenario, task.seed, task.job.steps or _limit(scenario))
        self.file.flush()

    def follow(self, simulation: Any) -> None:
        """Follow the steps of a new simulation."""
        if not self.planned:
            self.count += 1
            self.running.append((self.count, simulation))

    def write(self) -> None:
        """Write the episodes that have gone on since the last time."""
        for number, simulation in self.running:
            for world in range(simulation.copies):
                steps, key = int(simulation.count[world]), simulation.key(world)
                name = f"{number}/{world}/{key}"
                if steps and self.written.get(name) != steps:
                    self.written[name] = steps
                    self._add(name, simulation.scenario.source, simulation.scenario, key[0], steps)
        self.file.flush()

    def _add(self, key: str, path: str | None, scenario: Any, seed: int, steps: int | None) -> None:
        robots = [record for record in scenario.objects if record.role == "robot"]
        used = {str(model.name) for one in robots if (model := one.behavior or one.group_behavior) is not None}
        file = os.path.relpath(path) if path else ""
        data = {"key": key, "file": file, "behaviors": sorted(used), "seed": seed, "steps": steps}
        self.file.write(json.dumps(data) + "\n")


def _limit(scenario: Any) -> int | None:
    world = scenario.world
    return None if world.time_limit is None else round(world.time_limit / world.step_time)


def main() -> None:
    """Run the program that the first argument names."""
    program, seconds, *log = sys.argv[1:]
    folder = os.path.realpath(os.getcwd())
    import numpy  # noqa: F401  (libraries load their own parts before the hook watches)

    import irsim
    import irsim.benchmarks
    import irsim.env  # noqa: F401

    limit(cpu=math.ceil(time.process_time() + float(seconds)))
    if log:
        rehearse(Path(log[0]).absolute())

    def watch(event: str, arguments: tuple[Any, ...]) -> None:
        if event in _REFUSED:
            raise PermissionError(f"a runner may not do this: {event}")
        starts = event in ("subprocess.Popen", "os.posix_spawn") and arguments
        if starts and os.path.realpath(os.fsdecode(arguments[0])) != _PYTHON:
            raise PermissionError("a runner starts no other programs")
        if event == "open" and isinstance(arguments[0], (str, bytes)) and _writes(arguments):
            path = os.path.realpath(os.fsdecode(arguments[0]))
            if not path.startswith((folder + os.sep, "/dev/")):
                raise PermissionError(f"a runner writes only into its folder, not {path}")

    sys.dont_write_bytecode = True
    sys.argv = [program]
    sys.addaudithook(watch)
    runpy.run_path(program, run_name="__main__")


def _writes(arguments: tuple[Any, ...]) -> bool:
    mode, flags = arguments[1], arguments[2]
    return bool(flags & _WRITE) if mode is None else any(letter in str(mode) for letter in "wax+")


if __name__ == "__main__":
    main()
