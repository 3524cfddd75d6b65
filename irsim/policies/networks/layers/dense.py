"""``dense``: a linear map and an activation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from irsim.options.units import Bool
from irsim.policies.networks.layers._linear import Activation, activate, linear
from irsim.policies.networks.layers._options import LAYERS, Arrays, LayerOptions, Plan, Units, only
from irsim.policies.networks.values import Array, Shape, Value


class Dense(LayerOptions):
    """A linear map of the features and an activation; of a set, the same for each member.

    Arrays: `w` (inputs, units), the transpose of what PyTorch stores, and `b` (units).
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "dense", "label": "h1", "inputs": ["goal"], "units": 64, "activation": "relu"}]
    }

    name: Literal["dense"] = "dense"
    units: Units
    """Number of outputs."""
    activation: Activation = "none"
    """Function of the outputs."""
    bias: Bool = True
    """Whether there is a bias."""

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """One product of each input and output."""
        shape = only(inputs)
        arrays: dict[str, tuple[int, ...]] = {"w": (shape.features, self.units)}
        if self.bias:
            arrays["b"] = (self.units,)
        work = (shape.members or 1) * shape.features * self.units
        return Plan(Shape(self.units, shape.members), arrays, work)


@LAYERS.register(Dense)
def dense(options: Dense, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(..., O) ``f(x w + b)``."""
    (value,) = inputs
    w = arrays["w"]
    b = arrays["b"] if options.bias else w[:0].sum(axis=0)
    return Value(activate(options.activation, linear(value.array, w, b)), value.mask)
