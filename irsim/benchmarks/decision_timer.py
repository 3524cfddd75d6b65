"""Times the decisions of behaviors, which run in the engine: in an episode of their own, phase by phase."""

from __future__ import annotations

import time

import numpy as np

from irsim.benchmarks.episode import Job, environment_of
from irsim.benchmarks.timing import Decisions
from irsim.diagnostics.errors import PlacementError
from irsim.simulation.simulation import Simulation

__all__ = ["DecisionTimer", "time_behavior"]

_MAX_STEPS = 500
"""Number of steps that are timed."""


class DecisionTimer:
    """Part of the steps of a simulation with one world that times the phase in which behaviors decide.

    Args:
        simulation: The simulation, to whose ``decisions`` it is added.

    Attributes:
        seconds: Wall-clock time of the decisions of each step [s].
        decided: Number of robots that could move in this step.
    """

    def __init__(self, simulation: Simulation) -> None:
        self.seconds: list[float] = []
        self.decided: list[int] = []
        records = simulation.scenario.objects
        moving = [k for k, record in enumerate(records) if record.role == "robot" and not record.static]
        self._robots, self._began = np.array(moving, dtype=np.int64), 0.0

    def claim(self, simulation: Simulation) -> None:
        """The behaviors decide next."""
        count = int(np.count_nonzero(simulation.stopped[self._robots] == 0))
        self.decided.append(count)
        self._began = time.perf_counter()

    def __call__(self, simulation: Simulation) -> None:
        """The behaviors have decided."""
        self.seconds.append(time.perf_counter() - self._began)


def time_behavior(job: Job, seed: int) -> Decisions:
    """The times of the decisions of one episode; empty if its seed leaves no room for an object.

    The decisions of moving obstacles are among them.

    Args:
        job: A scenario under a behavior.
        seed: Its seed.
    """
    try:
        env = environment_of(job, seed)
    except PlacementError:
        return []
    timer = DecisionTimer(env.simulation)
    env.simulation.decisions.append(timer)
    env.simulation.advance(_MAX_STEPS if job.steps is None else min(job.steps, _MAX_STEPS), until_done=True)
    env.end(ending_time=0.0)
    pairs = [pair for pair in zip(timer.seconds, timer.decided, strict=True) if pair[1]]
    return pairs[1:]  # the first step also fills the caches of the processor
