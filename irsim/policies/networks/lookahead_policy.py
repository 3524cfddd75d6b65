"""Value networks as policies: they look one move ahead."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.policies.driver import decision_steps
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.graph import GraphPlan
from irsim.policies.networks.layout import observe
from irsim.policies.networks.lookahead import Futures, Lookahead, look_ahead, straight, take_rows
from irsim.policies.networks.network import Network
from irsim.policies.networks.network_policy import LayerPolicy
from irsim.policies.observations import Observations

__all__ = ["LookaheadPolicy", "best_moves"]

_MOVES_AT_ONCE = 8_000
"""Moves that are predicted together: as many robots as fit the caches."""


def best_moves(values: Floats, futures: Futures) -> Floats:
    """(B, 2) moves with the largest return, the first of equal ones.

    Args:
        values: (B, A) values of the states after the moves.
        futures: The moves.
    """
    returns = futures.reward + futures.discount[:, None] * values
    best = np.argmax(np.where(np.isnan(returns), -np.inf, returns), axis=1)
    chosen: Floats = futures.move[np.arange(len(best)), best]
    return chosen


class LookaheadPolicy(LayerPolicy):
    """A network that returns the value of a state; of several moves the one with the best predicted return is taken.

    Args:
        name: Its name in tables.
        network: The network, whose document has a lookahead.
        plan: What its layers need.
        facts: What :meth:`describe` adds.
    """

    def __init__(self, name: str, network: Network, plan: GraphPlan, facts: Mapping[str, Any] | None = None) -> None:
        super().__init__(name, network, plan, facts)
        assert network.document.lookahead is not None
        self.lookahead: Lookahead = network.document.lookahead

    def act(self, observations: Observations) -> Floats:
        """Decide for B robots; the decision of each is the same, bit for bit, in any batch.

        Raises:
            PolicyInputError: The robots do not observe what the network needs.
        """
        if not np.isfinite(observations.high[:, 0]).all():
            message = "the network chooses between shares of the largest speed, and a robot has none"
            raise PolicyInputError(message, "give the robot a finite vel_max")
        portion = max(1, _MOVES_AT_ONCE // self.lookahead.moves.count)
        moves = np.zeros((len(observations), 2))
        for first in range(0, len(observations), portion):
            some = slice(first, first + portion)
            moves[some] = self._choose(take_rows(observations, some))
        if self.output == "control":  # the change of the heading is spread over the time until the next decision
            moves[:, 1] /= decision_steps(self, observations.step_time) * observations.step_time
        return moves

    def _choose(self, o: Observations) -> Floats:
        """(B, 2) moves."""
        away = o.goal[:, :2] - o.pose[:, :2]
        there = np.isfinite(away).all(axis=1)
        distance = np.sqrt(away[:, 0] * away[:, 0] + away[:, 1] * away[:, 1])
        moves = straight(self.lookahead, o)
        moves[~there | (distance < o.goal_threshold)] = 0.0
        seen = o.neighbors
        sees = np.zeros(len(o), dtype=bool) if seen is None else seen.mask.any(axis=1)
        thinking = np.flatnonzero(there & ~(distance < o.goal_threshold) & sees)
        if thinking.size:
            futures = look_ahead(self.lookahead, take_rows(o, thinking))
            observed = observe(self.head.layout, futures.observations)
            values = self.compute(observed, futures.observations)[:, 0].astype(np.float64)
            moves[thinking] = best_moves(values.reshape(futures.reward.shape), futures)
        return moves

    def describe(self) -> dict[str, Any]:
        """Facts for people and programs: plain data for JSON."""
        return {**super().describe(), "lookahead": self.lookahead.model_dump(mode="json")}
