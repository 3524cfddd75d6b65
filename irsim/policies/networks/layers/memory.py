"""``memory``: a gated recurrent unit that remembers from one decision to the next."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from irsim.policies.networks.layers._linear import Gates, gates_arrays, gru_cell, linear
from irsim.policies.networks.layers._options import LAYERS, Arrays, LayerOptions, Plan, Units, vector
from irsim.policies.networks.values import Array, Shape, Value


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
    """(B, U) state; ``memory`` (B, U) holds that of the last decision and then this one."""
    assert memory is not None
    gates = Gates.of(arrays)
    state = gru_cell(linear(inputs[0].array, gates.input_weights, gates.input_bias), memory, gates)
    memory[:] = state
    return Value(state)
