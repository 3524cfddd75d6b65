"""Networks as policies: of layers, with what they remember of each robot, and value networks that look ahead."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.options.knowledge import Fact
from irsim.policies.driver import decision_steps
from irsim.policies.networks.document import PolicyHead
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.layout import layout_needs, layout_shapes, observe
from irsim.policies.networks.lookahead import Lookahead, best_moves, look_ahead, straight, take_rows
from irsim.policies.networks.network import GraphPlan, Network, run_graph
from irsim.policies.networks.output import Present, decide
from irsim.policies.networks.values import Array, Value
from irsim.policies.policy import Policy

if TYPE_CHECKING:
    from irsim.policies.observations import Observations

__all__ = ["LayerPolicy", "LookaheadPolicy", "NetworkPolicy", "Slots"]

_NUMBERS_AT_ONCE = 500_000
"""Results of layers that are computed together: as many robots as fit the caches, and never much memory."""
_MOVES_AT_ONCE = 8_000
"""Moves that are predicted together: as many robots as fit the caches."""


class NetworkPolicy(Policy):
    """A network that observes the parts of a layout.

    One that remembers knows robots by world and index, so one object drives one simulation at a time.

    Args:
        name: Its name in tables.
        head: Its observations, and the meaning of its result.
        facts: Additions to :meth:`describe`: format, size, hash.
    """

    stochastic = False
    batch_invariant = True

    def __init__(self, name: str, head: PolicyHead, facts: Mapping[str, Any]) -> None:
        self.name, self.head = name, head
        self.needs = layout_needs(head.layout)
        self.output = head.output.returns
        self.drives = None if head.drives is None else frozenset(head.drives)
        self.decision_dt = head.decision_dt
        self.digest = facts.get("sha256")
        self._facts = dict(facts)

    def known(self) -> frozenset[Fact]:
        """The facts that its parts observe."""
        return frozenset[Fact]().union(*(part.known() for part in self.head.layout.parts))

    def act(self, observations: Observations) -> Floats:
        """Decide for B robots; the decision of each is the same, bit for bit, in any batch.

        Raises:
            PolicyInputError: The robots do not observe what the network needs.
        """
        observed = observe(self.head.layout, observations)
        return decide(self.head.output, self.compute(observed, observations), Present.of(observations))

    @abstractmethod
    def compute(self, observed: Mapping[str, Value], observations: Observations) -> Array:
        """(B, F) result of the network.

        Args:
            observed: Parts of the layout.
            observations: Observations that they were made from.
        """

    def describe(self) -> dict[str, Any]:
        """Facts for people and programs: plain data for JSON."""
        head = self.head
        shapes = layout_shapes(head.layout)
        parts = [
            {"label": part.key, "shape": str(shapes[part.key]), **part.model_dump(mode="json", exclude={"label"})}
            for part in head.layout.parts
        ]
        return {
            "name": self.name,
            **self._facts,
            "observes": parts,
            "layout_version": head.layout.version,
            "output": head.output.model_dump(mode="json", exclude_defaults=True) | {"returns": self.output},
            "drives": None if self.drives is None else sorted(self.drives),
            "decision_dt": self.decision_dt,
            "card": head.card.model_dump(mode="json", exclude_defaults=True),
        }


class Slots:
    """One row of numbers for each robot of each world, given to it at its first decision.

    Args:
        sizes: Label of a layer -> how many numbers it remembers.
        dtype: Type of the numbers.
    """

    def __init__(self, sizes: Mapping[str, int], dtype: np.dtype[np.floating]) -> None:
        self._slots: dict[tuple[int, int], int] = {}
        self._memory: dict[str, Array] = {label: np.zeros((0, size), dtype) for label, size in sizes.items()}

    def recall(self, observations: Observations) -> tuple[NDArray[np.intp], dict[str, Array]]:
        """The row of each robot, and what was remembered: zeros at the first decision of an episode."""
        keys = zip(observations.world.tolist(), observations.robot.tolist(), strict=True)
        known = self._slots
        rows = np.array([known.setdefault(key, len(known)) for key in keys], dtype=np.intp)
        for label, memory in self._memory.items():
            if len(memory) < len(known):
                grown = np.zeros((max(len(known), 2 * len(memory)), memory.shape[1]), memory.dtype)
                grown[: len(memory)] = memory
                self._memory[label] = grown
        fresh = observations.first[:, None]
        return rows, {label: np.where(fresh, 0, memory[rows]) for label, memory in self._memory.items()}

    def store(self, rows: NDArray[np.intp], remembered: Mapping[str, Array]) -> None:
        """Keep what layers have written."""
        for label, memory in remembered.items():
            self._memory[label][rows] = memory


class LayerPolicy(NetworkPolicy):
    """A network of the layers of irsim.

    Args:
        name: Its name in tables.
        network: The network.
        plan: Needs of its layers.
        facts: Additions to :meth:`describe`.
    """

    def __init__(self, name: str, network: Network, plan: GraphPlan, facts: Mapping[str, Any] | None = None) -> None:
        document = network.document
        size = {"parameters": plan.parameters, "work": plan.work, "memory": sum(plan.memory.values())}
        layers = [f"{layer.label}: {layer.name} ({plan.shapes[layer.label]})" for layer in document.network]
        super().__init__(name, document, {**(facts or {}), **size, "precision": document.precision, "layers": layers})
        self._network, self._arrays = network, network.by_layer()
        self._dtype = np.dtype(document.precision)
        self._rows = max(1, _NUMBERS_AT_ONCE // max(1, plan.numbers))
        self._slots = Slots(plan.memory, self._dtype) if plan.memory else None

    def memory(self) -> dict[str, Any] | None:
        """The memory that its layers have of each robot; None if they have no memory."""
        return None if self._slots is None else {"_slots": self._slots}

    def compute(self, observed: Mapping[str, Value], observations: Observations) -> Array:
        """(B, F) result of the layers."""
        values = {label: Value(value.array.astype(self._dtype), value.mask) for label, value in observed.items()}
        rows, memory = (None, {}) if self._slots is None else self._slots.recall(observations)
        results = []
        with np.errstate(all="ignore"):  # what is not finite is reported where the result is used
            for first in range(0, max(len(observations), 1), self._rows):
                some = slice(first, first + self._rows)
                seen = {label: value.rows(some) for label, value in values.items()}
                kept = {label: state[some] for label, state in memory.items()}  # views, which layers write
                document = self._network.document
                results.append(run_graph(document.network, self._arrays, seen, kept, document.output.input).array)
        if self._slots is not None and rows is not None:
            self._slots.store(rows, memory)
        return np.concatenate(results)


class LookaheadPolicy(LayerPolicy):
    """A network that returns the value of a state; of several moves the one with the best predicted return is taken.

    Args:
        name: Its name in tables.
        network: The network, whose document has a lookahead.
        plan: Needs of its layers.
        facts: Additions to :meth:`describe`.
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
            message = "the network chooses between shares of the largest speed, but a robot's is infinite"
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
