"""``select``: some of the features."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.options.units import Count, Integer
from irsim.policies.networks.layers._options import LAYERS, Arrays, LayerOptions, Plan, ShapeError, only
from irsim.policies.networks.values import Array, Shape, Value


class Select(LayerOptions):
    """The features with the indices from `start` up to, but not including, `stop`."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "select", "label": "speed", "inputs": ["own"], "start": 0, "stop": 1}]
    }

    name: Literal["select"] = "select"
    start: Count = 0
    """Index of the first feature."""
    stop: Annotated[Integer, Field(ge=1)]
    """Index after the last feature."""

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """The selected features."""
        shape = only(inputs)
        if not self.start < self.stop <= shape.features:
            raise ShapeError(f"selects features {self.start} to {self.stop} of {shape.features}")
        return Plan(Shape(self.stop - self.start, shape.members), {}, 0)


@LAYERS.register(Select)
def select(options: Select, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(..., F) selected features."""
    (value,) = inputs
    return Value(value.array[..., options.start : options.stop], value.mask)
