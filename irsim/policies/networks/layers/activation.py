"""``activation``: a function of each feature."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from irsim.policies.networks.layers._linear import Activation, activate
from irsim.policies.networks.layers._options import LAYERS, Arrays, LayerOptions, Plan, only
from irsim.policies.networks.values import Array, Shape, Value


class ActivationLayer(LayerOptions):
    """A function of each feature, such as after the sum of a residual connection."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "activation", "label": "a", "inputs": ["sum"], "function": "relu"}]
    }

    name: Literal["activation"] = "activation"
    function: Activation
    """The function."""

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """The shape of the input."""
        shape = only(inputs)
        return Plan(shape, {}, 20 * (shape.members or 1) * shape.features)


@LAYERS.register(ActivationLayer)
def activation(options: ActivationLayer, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """The function of each feature."""
    (value,) = inputs
    return Value(activate(options.function, value.array), value.mask)
