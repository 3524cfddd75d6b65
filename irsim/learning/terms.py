"""Reward terms that Python computes: functions of users and plug-ins, over all learners at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.learning.rewards._options import REWARDS, RewardOptions
from irsim.learning.step import Moment, Result
from irsim.policies.networks.layout import Layout
from irsim.policies.networks.parts.rvo import RvoCones
from irsim.policies.observe import Observer
from irsim.scenario.resolve.kernels import kernel_options

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["PythonTerms", "weighted_terms"]


def weighted_terms(terms: Sequence[RewardOptions]) -> list[tuple[Any, float]]:
    """Options for the core and weight of each term; None for terms that Python computes."""
    return [(kernel_options(REWARDS, term), float(term.weight)) for term in terms]


class PythonTerms:
    """The terms of a task that are functions of a :class:`irsim.learning.Moment`.

    Args:
        simulation: The simulation.
        terms: All terms of the task.
        indices: (A,) indices of the learners in a world.
        rows: (n * A,) their rows.
        kinds: (N,) what each object is, see :func:`irsim._core.gaps`.
        threads: Number of threads.
    """

    def __init__(
        self,
        simulation: Simulation,
        terms: Sequence[RewardOptions],
        indices: NDArray[np.int64],
        rows: NDArray[np.int64],
        kinds: NDArray[np.uint8],
        threads: int,
    ) -> None:
        self._simulation, self._rows, self._kinds, self._threads = simulation, rows, kinds, threads
        features = [(number, REWARDS.get(term.name), term) for number, term in enumerate(terms)]
        self._terms = [(k, feature.function, term) for k, feature, term in features if feature and feature.function]
        wary = any(term.name == "rvo" for term in terms)
        self._threats = Threats(simulation, indices, threads) if wary else None
        self._shape = len(rows) // len(indices), len(indices)
        self._before: dict[str, Floats] = {}

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self._terms)

    def look(self) -> None:
        """Keep what the terms need from before the step, after the learners were commanded."""
        simulation, rows = self._simulation, self._rows
        self._before = {
            "pose_before": simulation.pose.take(rows, axis=0),
            "goal": simulation.goal.take(rows, axis=0),
            "control_before": simulation.control.take(rows, axis=0),
            "commanded": simulation.state.commanded.take(rows, axis=0),
        }
        self._urgency = np.zeros(len(rows)) if self._threats is None else self._threats.urgency(rows)

    def add(self, result: Result, present: NDArray[np.bool_]) -> Result:
        """The result of a step with these terms. Absent learners earn nothing: their places are not numbers."""
        moment = self._moment(result)
        for number, function, options in self._terms:
            term = result.terms[number]
            np.multiply(options.weight, function(moment, options), out=term)
            term *= result.active
            term[~present] = 0.0
        return replace(result, reward=result.terms.sum(axis=0))

    def _moment(self, result: Result) -> Moment:
        simulation, rows, shape = self._simulation, self._rows, self._shape
        state = simulation.state
        twist = simulation.twist.take(rows, axis=0)
        reached = ~_same(simulation.goal.take(rows, axis=0), self._before["goal"]).reshape(shape)
        urgency = self._urgency.reshape(shape)
        return Moment(
            step_time=float(simulation.scenario.world.step_time),
            pose=simulation.pose.take(rows, axis=0).reshape(*shape, 3),
            reached=(reached & result.active) | result.arrived,
            arrived=result.arrived,
            collided=result.collided,
            control=simulation.control.take(rows, axis=0).reshape(*shape, 3),
            low=state.vel_min.take(rows, axis=0).reshape(*shape, 3),
            high=state.vel_max.take(rows, axis=0).reshape(*shape, 3),
            velocity=twist[:, :2].reshape(*shape, 2),
            yaw_rate=twist[:, 2].reshape(shape),
            gaps=self._gaps(),
            urgency=lambda: urgency,
            **{name: values.reshape(*shape, -1) for name, values in self._before.items()},
        )

    def _gaps(self) -> Callable[[float], Floats]:
        """The distances to other objects now, measured once for each reach."""
        known: dict[float, Floats] = {}

        def gaps(reach: float) -> Floats:
            if reach not in known:
                world, state = self._simulation.world, self._simulation.state
                measured = core.gaps(world, state, self._rows, self._kinds, reach, self._threads)
                known[reach] = measured.reshape(*self._shape, 3)
            return known[reach]

        return gaps


def _same(a: Floats, b: Floats) -> NDArray[np.bool_]:
    """Whether goals are equal, (B,)."""
    equal: NDArray[np.bool_] = ((a == b) | (np.isnan(a) & np.isnan(b))).all(axis=1)
    return equal


_URGENCY = 7
"""Index of the urgency among the numbers of a cone."""


class Threats:
    """The urgency of the most urgent velocity obstacle of each learner, see the observation part ``rvo_cones``.

    Args:
        simulation: The simulation.
        indices: (A,) indices of the learners in a world.
        threads: Number of threads.
    """

    def __init__(self, simulation: Simulation, indices: NDArray[np.int64], threads: int) -> None:
        part = RvoCones(count=1, decimals=None)
        self._simulation, self._threads = simulation, threads
        self._looking = Observer(simulation, part.needs(), indices).looking
        self._kernel = Layout(parts=[part]).kernels[0]

    def urgency(self, rows: NDArray[np.int64]) -> Floats:
        """(B,) 1 / (t + 0.2 s), with the time t to the first touch; 0 without a touch within 5 s."""
        observed = np.empty((len(rows), _URGENCY + 1), dtype=np.float32)
        world, state = self._simulation.world, self._simulation.state
        core.observe_rows(world, state, self._looking, [(self._kernel, 0)], rows, observed, self._threads)
        return observed[:, _URGENCY].astype(np.float64)
