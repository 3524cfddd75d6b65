"""Which episodes a program starts: written down while it is rehearsed, in its own process, and read afterwards.

In a rehearsal nothing moves: a step only counts. So every episode goes on to the horizon that the program has for it,
and hundreds of episodes take seconds. A benchmark runs one episode, whose result stands for all.
"""

from __future__ import annotations

import atexit
import json
import os
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

__all__ = ["Started", "read_log", "rehearse"]

_WATCHED = 8
"""Number of simulations whose steps are followed at the same time; a program steps the newest ones."""


@dataclass(frozen=True)
class Started:
    """One episode that a program has started or planned.

    Attributes:
        file: Path of the scenario, relative to the folder of the answer; empty for a text.
        behaviors: Names of the behaviors of its robots.
        seed: Its seed.
        steps: Number of steps of the episode if nobody arrives; None where only the scenario ends it, and it does not
            say when.
    """

    file: str
    behaviors: tuple[str, ...]
    seed: int
    steps: int | None


def read_log(path: Path) -> list[Started]:
    """The episodes in the order in which they were started; without a file there are none."""
    if not path.is_file():
        return []
    found: dict[Any, Started] = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines()):
        try:
            data = json.loads(line)
        except ValueError:  # the process was ended while it wrote
            continue
        key = data.pop("key") or number
        found[str(key)] = Started(**{**data, "behaviors": tuple(data["behaviors"])})
    return list(found.values())


def rehearse(path: Path) -> None:
    """Simulate nothing from now on, and write down what episodes this process starts: those of benchmarks when they are
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
