"""Worlds of a task that are divided among processes."""

from __future__ import annotations

import os
import sys
import weakref
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from irsim.common.arguments import as_given, check_whole_number
from irsim.common.arrays import Floats
from irsim.diagnostics.errors import ArgumentError, InputError
from irsim.env.batch import check_worlds
from irsim.learning.actions import read_actions
from irsim.learning.step import Result, Step
from irsim.learning.tasks.files import TaskSource
from irsim.learning.workers.memory import SharedMemory
from irsim.learning.workers.part import DRAWN, RESULTS, Part, layout_of, python_parts
from irsim.learning.workers.process import Worker, stop
from irsim.learning.worlds import Autoreset, Worlds
from irsim.simulation.simulation import Simulation

__all__ = ["AnyWorlds", "DividedWorlds", "open_slots", "open_worlds"]

MAX_WORKERS = 256
"""Largest number of processes."""


class DividedWorlds:
    """``n`` worlds as :class:`irsim.learning.Worlds`, bit for bit, of which each process steps a part.

    Worlds are divided in their order. This process steps the first part, so that w workers are w - 1 further processes.
    They end with :meth:`close`, with this object, and with this process, however it ends.

    Args:
        task: The task: its file, its data, or a task that was read.
        n: Number of worlds.
        workers: Number of processes; at most one for each world.
        seed: Seed of the first world, the next one has the next number; None: ``seeds.train`` of the task.
        threads: Number of threads of all processes together; each has at least one.
        level: Level of the curriculum; None: the one that it starts with.

    Attributes:
        task, scenario, n, learners, names, eyes, width, present, level, drawn: As for the worlds.

    Raises:
        TaskError: The task is not valid, or does not fit its scenario.
        ScenarioError: The scenario cannot be used.
        ArgumentError: There is no such level, or another process cannot make the worlds.
        WorkerError: A process has died.
    """

    def __init__(
        self,
        task: TaskSource,
        n: int,
        workers: int,
        *,
        seed: int | None = None,
        threads: int = 1,
        level: int | None = None,
    ) -> None:
        parts = min(workers, n)
        bounds = [n * k // parts for k in range(parts + 1)]
        self._memory = SharedMemory()
        self._workers: list[Worker] = []
        self._owner = os.getpid()
        self._finish = weakref.finalize(self, stop, self._workers, self._owner)
        try:
            for _ in range(1, parts):
                self._workers.append(Worker(self._memory.inherited))
            own = Worlds(task, bounds[1], seed=seed, threads=max(1, threads // parts), level=level)
            self._start(own, task if isinstance(task, str | os.PathLike) else own.task, bounds, threads, level)
        except BaseException:
            self.close()
            raise
        finally:
            self._memory.close()

    def _start(self, own: Worlds, task: TaskSource, bounds: list[int], threads: int, level: int | None) -> None:
        n, parts = bounds[-1], len(bounds) - 1
        layout = layout_of(own, n, parts)
        for number, worker in enumerate(self._workers, 1):
            first = bounds[number]
            count = bounds[number + 1] - first
            seed = own.seeds[0] + first
            made = {"task": task, "n": count, "seed": seed, "threads": max(1, threads // parts), "level": level}
            place = {"memory": self._memory.key, "number": number, "first": first}
            worker.send({**made, **place, "argv": sys.argv, "python": python_parts(own)})
            worker.send(layout)
        self._arrays = self._memory.arrays(layout)
        self._own = own
        self._part = Part(own, 0, 0, layout, self._arrays)
        self.task, self.scenario, self.names, self.eyes = own.task, own.scenario, own.names, own.eyes
        self.n, self.learners, self.width = n, own.learners, own.width
        self._seeds = [own.seeds[0] + i for i in range(n)]
        self._told = -1
        errors = self._answers()
        if errors:
            what = f"a worker process cannot make the worlds: {errors[0]}"
            fix = "put what the task uses into modules that Python can import, or leave out workers"
            raise ArgumentError(what, fix) from errors[0]
        self._read_draws()

    def snapshot(self, *data: bytes) -> NoReturn:
        """Refuse, as ``restore`` and copies do: the state is in several processes.

        Raises:
            InputError: Always.
        """
        raise InputError("worlds of several processes have no snapshots and no copies", "leave out workers")

    restore = __reduce__ = snapshot

    @property
    def varies(self) -> bool:
        """Whether the task draws more for each episode than its scenario does."""
        return self._own.varies

    @property
    def seeds(self) -> list[int]:
        """(n,) present seeds."""
        return list(self._seeds)

    @property
    def simulation(self) -> Simulation:
        """The simulation behind the worlds of this process, which are the first ones."""
        return self._own.simulation

    @property
    def pids(self) -> list[int]:
        """Numbers of the further processes."""
        return [worker.pid for worker in self._workers]

    def buffer(self) -> NDArray[np.float32]:
        """(n * A, D) the shared array of observations, into which all processes write."""
        seen: NDArray[np.float32] = self._arrays["seen"]
        return seen

    def read(self, actions: Any) -> Floats | None:
        """As :meth:`irsim.learning.Worlds.read`."""
        slots = self.n * self.learners
        return None if actions is None else read_actions(actions, self.task.action.choices, slots, self.width)

    def reset(self, mask: NDArray[np.bool_] | None = None, *, seeds: Sequence[int] | None = None) -> None:
        """As :meth:`irsim.learning.Worlds.reset`."""
        chosen = np.ones(self.n, dtype=bool) if mask is None else np.array(mask, dtype=bool)
        if chosen.shape != (self.n,):
            raise ArgumentError(f"a mask of {self.n} worlds has the shape ({self.n},), not {chosen.shape}", "give one")
        self._arrays["mask"][...] = chosen
        if seeds is not None:
            if len(seeds) != self.n:
                raise ArgumentError(f"{len(seeds)} seeds are given for {self.n} worlds", "give one for each")
            self._arrays["seeds"][...] = np.asarray(seeds, dtype=np.uint64)
            self._seeds = [seeds[i] if chosen[i] else old for i, old in enumerate(self._seeds)]
        self._do("reset", seeds is not None)

    def set_level(self, level: int) -> None:
        """As :meth:`irsim.learning.Worlds.set_level`."""
        self._own.set_level(level)  # first, so that a wrong level changes nothing
        self._do("set_level", level)

    def observe(self, out: NDArray[np.float32] | None = None) -> NDArray[np.float32]:
        """As :meth:`irsim.learning.Worlds.observe`."""
        self._do("observe")
        return self._seen(out)

    def step(self, actions: Any) -> Result:
        """As :meth:`irsim.learning.Worlds.step`."""
        return self.advance(self.read(actions), out=self.buffer()).result

    def advance(
        self,
        numbers: Floats | None,
        reset: Autoreset | None = None,
        *,
        out: NDArray[np.float32] | None = None,
        watch: Callable[[Result], None] | None = None,
    ) -> Step:
        """As :meth:`irsim.learning.Worlds.advance`; ``last`` of what it returns is overwritten by the next call."""
        if numbers is not None:
            self._arrays["actions"][...] = numbers
        watched = watch is not None and reset == "over"  # what is watched decides about the next episodes
        self._do("advance", numbers is not None, None if watched else reset)
        result = Result(**{name: self._arrays[name].copy() for name in RESULTS})
        if watch is not None:
            watch(result)
        if watched and result.over.any():
            self._do("renew")
        return Step(result, self._seen(out), self._arrays["last"])

    def close(self) -> None:
        """End the processes. Nothing can be stepped afterwards."""
        self._finish()

    def _seen(self, out: NDArray[np.float32] | None) -> NDArray[np.float32]:
        """The observations in an array of the caller, or in a new one."""
        seen = self.buffer()
        if out is None:
            return seen.copy()
        if out is not seen:
            out[...] = seen
        return out

    def _do(self, *command: Any) -> None:
        """Have all processes carry out a command.

        Raises:
            BaseException: The worker's exception; if several failed, the one of the lowest worker.
        """
        if not self._finish.alive:
            raise ArgumentError("the environment is closed, and its worker processes have ended", "make a new one")
        if os.getpid() != self._owner:
            raise ArgumentError("the environment was made by another process", "make one in this process")
        try:
            for worker in self._workers:
                worker.send(command)
        except BaseException:
            self.close()
            raise
        try:
            self._part.do(command)
        finally:
            errors = self._answers()
        if errors:
            raise errors[0]
        self._read_draws()

    def _answers(self) -> list[BaseException]:
        """The errors that the processes answer with."""
        try:
            return [error for worker in self._workers if (error := worker.receive()) is not None]
        except BaseException:  # a process has died, or Ctrl-C while answers are outstanding
            self.close()
            raise

    def _read_draws(self) -> None:
        """Find out what was drawn, if episodes have begun."""
        told = int(self._arrays["episodes"].sum())
        if told == self._told:
            return
        self._told = told
        self.present, self.level = self._arrays["present"].copy(), self._arrays["level"].copy()
        names = self._own.drawn
        self.drawn: dict[str, NDArray[Any]] = {name: self._arrays[DRAWN + name].copy() for name in names}


AnyWorlds = Worlds | DividedWorlds
"""Worlds in one process, or divided among several."""


def open_worlds(
    task: TaskSource,
    n: int = 1,
    *,
    seed: int | None = None,
    threads: int = 1,
    workers: int = 1,
    level: int | None = None,
) -> AnyWorlds:
    """Open worlds in one process, or divided among several.

    Args:
        task: The task: its file, its data, or a task that was read.
        n: Number of worlds.
        seed: Seed of the first world, the next one has the next number; None: ``seeds.train`` of the task.
        threads: Number of threads of all processes together.
        workers: Number of processes, this one included.
        level: Level of the curriculum; None: the one that it starts with.

    Raises:
        TaskError: The task is not valid, or does not fit its scenario.
        ScenarioError: The scenario cannot be used.
        ArgumentError: There is no such level or number of workers, or another process cannot make the worlds.
    """
    if isinstance(workers, bool) or not 1 <= workers <= MAX_WORKERS:
        raise ArgumentError(f"workers is {as_given(workers)}", f"give a whole number from 1 to {MAX_WORKERS}")
    if min(workers, n) < 2:
        return Worlds(task, n, seed=seed, threads=threads, level=level)
    return DividedWorlds(task, n, workers, seed=seed, threads=threads, level=level)


def open_slots(
    task: TaskSource,
    num_envs: int | None,
    worlds: int | None = None,
    *,
    seed: int | None = None,
    threads: int = 1,
    workers: int = 1,
) -> AnyWorlds:
    """Open the worlds of as many learners as a learning library asks for.

    Args:
        task: The task: its file, its data, or a task that was read.
        num_envs: Number of learners of all worlds together; None: as many as ``worlds`` have.
        worlds: Number of worlds, instead of ``num_envs``; None: one.
        seed: Seed of the first world, the next one has the next number; None: ``seeds.train`` of the task.
        threads: Number of threads of all processes together.
        workers: Number of processes, this one included.

    Raises:
        ArgumentError: The number is not one of whole worlds, or given in both ways.
        Others: as :func:`open_worlds`.
    """
    if num_envs is not None and worlds is not None:
        raise ArgumentError("num_envs and worlds are two names of one number", "give only num_envs")
    if num_envs is None:
        return open_worlds(task, 1 if worlds is None else worlds, seed=seed, threads=threads, workers=workers)
    one = Worlds(task, 1, seed=seed)
    if check_whole_number("num_envs", num_envs, 1) % one.learners:
        what = f"num_envs is {num_envs}, and each world has {one.learners} learners"
        raise ArgumentError(what, f"give a multiple of {one.learners}")
    if num_envs == one.learners:
        return one
    n = check_worlds(num_envs // one.learners, one.scenario)
    return open_worlds(task, n, seed=seed, threads=threads, workers=workers)
