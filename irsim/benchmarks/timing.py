"""How long policies take to decide: wall-clock times, which are not part of results and have a file of their own."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from irsim.benchmarks.episode import Job, environment_of
from irsim.diagnostics.errors import PlacementError
from irsim.simulation.simulation import Simulation

__all__ = ["Decisions", "time_behavior", "timing_report", "was_timed"]

Decisions = Sequence[tuple[float, int]]
"""Wall-clock time [s] of each decision of a policy, and the number of robots that it decided for."""
_EARLIER = "its episodes were run before the benchmark was resumed"
_NONE = "no robot needed a decision"


def timing_report(policies: Mapping[str, Mapping[str, Decisions]], episodes: Mapping[str, int]) -> dict[str, Any]:
    """Summarise the times of decisions.

    Args:
        policies: Policy → the decisions of each episode that was timed.
        episodes: Policy → number of its episodes.

    Returns:
        For each policy ``mean_ms`` and ``p95_ms`` per decision and per robot, or the reason why they are missing.
    """
    return {"policies": {name: _summary(timed, episodes[name]) for name, timed in policies.items()}}


def was_timed(report: Mapping[str, Any]) -> bool:
    """Whether a report has times."""
    return any("per_decision" in policy for policy in report["policies"].values())


def _summary(timed: Mapping[str, Decisions], episodes: int) -> dict[str, Any]:
    pairs = np.array([pair for decisions in timed.values() for pair in decisions], dtype=np.float64).reshape(-1, 2)
    if not len(pairs):
        return {"reason": _NONE if timed else _EARLIER}
    each = np.repeat(pairs[:, 0] / pairs[:, 1], pairs[:, 1].astype(np.int64))
    return {
        "episodes": len(timed),
        "episodes_in_all": episodes,
        "decisions": len(pairs),
        "robots_per_decision": round(float(pairs[:, 1].mean()), 3),
        "per_decision": _milliseconds(pairs[:, 0]),
        "per_robot": _milliseconds(each),
    }


def _milliseconds(seconds: np.ndarray[Any, np.dtype[np.float64]]) -> dict[str, float]:
    values = 1e3 * seconds
    return {"mean_ms": round(float(values.mean()), 5), "p95_ms": round(float(np.percentile(values, 95)), 5)}


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
