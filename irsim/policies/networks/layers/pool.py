"""``pool``: one vector of the members of a set."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

import numpy as np

from irsim.policies.networks.layers._options import LAYERS, Arrays, LayerOptions, Plan, ShapeError, only
from irsim.policies.networks.values import Array, Shape, Value, add_in_order


class Pool(LayerOptions):
    """Maximum, mean or sum over the members that are present; zeros if there is none."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "pool", "label": "crowd", "inputs": ["each"], "method": "max"}]
    }

    name: Literal["pool"] = "pool"
    method: Literal["max", "mean", "sum"] = "max"
    """What is computed of each feature."""

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """A vector of as many features."""
        shape = only(inputs)
        if shape.members is None:
            raise ShapeError(f"takes a set, not a vector of {shape}")
        return Plan(Shape(shape.features), {}, shape.members * shape.features)


@LAYERS.register(Pool)
def pool(options: Pool, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(B, F) of (B, K, F) sets."""
    (value,) = inputs
    assert value.mask is not None
    if options.method == "max":
        largest = np.where(value.mask[:, :, None], value.array, -np.inf).max(axis=1)
        there = value.mask.any(axis=1, keepdims=True)
        return Value(
            np.where(there, largest, 0) + 0
        )  # which of -0 and 0 is larger depends on the loop that NumPy takes
    total = add_in_order(np.moveaxis(value.present(), 1, 0))
    if options.method == "mean":
        total = total / np.maximum(value.mask.sum(axis=1), 1)[:, None].astype(total.dtype)
    return Value(total)
