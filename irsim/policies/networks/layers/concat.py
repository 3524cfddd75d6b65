"""``concat``: features of several inputs one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

import numpy as np

from irsim.policies.networks.layers._linear import mask_of, spread
from irsim.policies.networks.layers._options import LAYERS, Arrays, LayerOptions, Plan, same_set
from irsim.policies.networks.values import Array, Shape, Value


class Concat(LayerOptions):
    """The features of the inputs one after the other. Members of sets get those of vectors, too."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "concat", "label": "all", "inputs": ["goal", "own"]}]
    }

    name: Literal["concat"] = "concat"

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """All features; a set if one of the inputs is."""
        members = same_set(inputs)
        return Plan(Shape(sum(shape.features for shape in inputs), members), {}, 0)


@LAYERS.register(Concat)
def concat(options: Concat, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(..., F) all features."""
    mask = mask_of(inputs)
    if mask is None:
        return Value(np.concatenate([value.array for value in inputs], axis=1))
    return Value(np.concatenate([spread(value, mask.shape[1]) for value in inputs], axis=2), mask)
