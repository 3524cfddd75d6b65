"""``flatten``: a vector of all members of a set."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from irsim.policies.networks.layers._options import LAYERS, Arrays, LayerOptions, Plan, ShapeError, only
from irsim.policies.networks.values import Array, Shape, Value


class Flatten(LayerOptions):
    """The features of all members one after the other; absent members are zeros."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "flatten", "label": "f", "inputs": ["neighbors"]}]}

    name: Literal["flatten"] = "flatten"

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """A vector of all features of all members."""
        shape = only(inputs)
        if shape.members is None:
            raise ShapeError(f"takes a set, not a vector of {shape}")
        return Plan(Shape(shape.members * shape.features), {}, 0)


@LAYERS.register(Flatten)
def flatten(options: Flatten, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(B, K F) of (B, K, F)."""
    (value,) = inputs
    return Value(value.flat())
