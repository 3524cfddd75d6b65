"""Gated recurrent units: over the members of a set, and from one decision to the next."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, ClassVar, Literal

import numpy as np

from irsim.policies.networks.layers._options import (
    LAYERS,
    Arrays,
    Gates,
    LayerOptions,
    Plan,
    ShapeError,
    Units,
    gates_arrays,
    gru_cell,
    linear,
    only,
    vector,
)
from irsim.policies.networks.values import Array, Shape, Value

_BACK = "_back"


class Gru(LayerOptions):
    """Read the members of a set one after the other and return the last state; absent members are skipped.

    Arrays in the form of PyTorch, transposed, with columns of the reset gate, the update gate and the new state: `wx`
    (features, 3 units), `bx`, `wh` (units, 3 units), `bh`; for `backward` and `both` the same with `_back`.

    Source: Cho et al.: Learning Phrase Representations using RNN Encoder-Decoder (2014).
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "gru", "label": "crowd", "inputs": ["neighbors"], "units": 256, "direction": "both"}]
    }

    name: Literal["gru"] = "gru"
    units: Units
    """Number of outputs of a direction."""
    direction: Literal["forward", "backward", "both"] = "forward"
    """Whether it reads from the first member, from the last, or both."""
    merge: Literal["concat", "sum"] = "concat"
    """How the last states of both directions are combined."""
    result: Literal["last", "all"] = "last"
    """Return the last state, or a set with the state after each member."""

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Endings of the names of its arrays."""
        return {"forward": ("",), "backward": (_BACK,), "both": ("", _BACK)}[self.direction]

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """A vector of the states, or a set."""
        shape = only(inputs)
        if shape.members is None:
            raise ShapeError(f"reads a set, not a vector of {shape}; memory reads vectors over time")
        arrays: dict[str, tuple[int, ...]] = {}
        for suffix in self.suffixes:
            arrays |= gates_arrays(shape.features, self.units, suffix)
        ways = len(self.suffixes)
        features = self.units * (ways if self.merge == "concat" else 1)
        work = ways * shape.members * 3 * self.units * (shape.features + self.units + 20)
        return Plan(Shape(features, shape.members if self.result == "all" else None), arrays, work)


@LAYERS.register(Gru)
def gru(options: Gru, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(B, F) last states, or (B, K, F) states, of (B, K, I) sets."""
    (value,) = inputs
    assert value.mask is not None
    count = value.array.shape[1]
    collected = []
    for suffix in options.suffixes:
        order = range(count - 1, -1, -1) if suffix == _BACK else range(count)
        collected.append(_read(value, Gates.of(arrays, suffix), order))
    last = options.result == "last"
    parts = [states[end] if last else states for states, end in collected]
    if options.merge == "sum":
        result = parts[0] if len(parts) == 1 else parts[0] + parts[1]
    else:
        result = np.concatenate(parts, axis=-1)
    return Value(result) if last else Value(np.moveaxis(result, 0, 1), value.mask)


def _read(value: Value, gates: Gates, order: Iterable[int]) -> tuple[Array, int]:
    """(K, B, U) states after each member in this order, and the index of the last one read."""
    assert value.mask is not None
    projected = linear(value.present(), gates.input_weights, gates.input_bias)
    rows, count = value.mask.shape
    state = np.zeros((rows, gates.state_weights.shape[0]), projected.dtype)
    states = np.empty((count, *state.shape), projected.dtype)
    k = 0
    for k in order:
        state = np.where(value.mask[:, k, None], gru_cell(projected[:, k], state, gates), state)
        states[k] = state
    return states, k


class Memory(LayerOptions):
    """A state of each robot that each of its decisions updates; it is 0 at the start of an episode.

    Arrays as of `gru`: `wx` (features, 3 units), `bx`, `wh` (units, 3 units), `bh`.

    Source: Cho et al.: Learning Phrase Representations using RNN Encoder-Decoder (2014).
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "memory", "label": "m", "inputs": ["h1"], "units": 64}]
    }

    name: Literal["memory"] = "memory"
    units: Units
    """Number of outputs, all of which are remembered."""

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """A vector of the state."""
        shape = vector(inputs)
        work = 3 * self.units * (shape.features + self.units + 20)
        return Plan(Shape(self.units), gates_arrays(shape.features, self.units), work, memory=self.units)


@LAYERS.register(Memory)
def remember(options: Memory, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(B, U) state; ``memory`` (B, U) holds the state of the last decision and then this one."""
    assert memory is not None
    gates = Gates.of(arrays)
    state = gru_cell(linear(inputs[0].array, gates.input_weights, gates.input_bias), memory, gates)
    memory[:] = state
    return Value(state)
