"""``add``: the sum of several inputs, for residual connections."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from irsim.policies.networks.layers._linear import mask_of, spread
from irsim.policies.networks.layers._options import LAYERS, Arrays, LayerOptions, Plan, ShapeError, same_set
from irsim.policies.networks.values import Array, Shape, Value, add_in_order


class Add(LayerOptions):
    """The sum of inputs with equally many features; vectors are added to each member of sets."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "add", "label": "sum", "inputs": ["h1", "h2"]}]}

    name: Literal["add"] = "add"

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """As many features; a set if one of the inputs is."""
        members = same_set(inputs)
        sizes = sorted({shape.features for shape in inputs})
        if len(sizes) > 1:
            raise ShapeError(f"adds inputs with equally many features, not {' and '.join(map(str, sizes))}")
        return Plan(Shape(sizes[0], members), {}, len(inputs) * (members or 1) * sizes[0])


@LAYERS.register(Add)
def add(options: Add, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(..., F) sum."""
    mask = mask_of(inputs)
    if mask is None:
        return Value(add_in_order(value.array for value in inputs))
    return Value(add_in_order(spread(value, mask.shape[1]) for value in inputs), mask)
