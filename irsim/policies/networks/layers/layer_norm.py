"""``layer_norm``: features of mean 0 and variance 1."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

import irsim._core as core
from irsim.options.units import Bool, Number
from irsim.policies.networks.layers._options import LAYERS, Arrays, LayerOptions, Plan, only
from irsim.policies.networks.values import Array, Shape, Value


class LayerNorm(LayerOptions):
    """Shift and scale the features of each robot, or of each member of a set, to mean 0 and variance 1.

    Arrays with `affine`: `scale` and `shift` (features), applied afterwards.

    Source: Ba, Kiros, Hinton: Layer Normalization (2016).
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "layer_norm", "label": "n", "inputs": ["h1"]}]}

    name: Literal["layer_norm"] = "layer_norm"
    epsilon: Annotated[Number, Field(gt=0)] = 1e-5
    """Added to the variance."""
    affine: Bool = True
    """Whether each feature is scaled and shifted afterwards."""

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """The shape of the input."""
        shape = only(inputs)
        arrays: dict[str, tuple[int, ...]] = (
            {"scale": (shape.features,), "shift": (shape.features,)} if self.affine else {}
        )
        return Plan(shape, arrays, 4 * (shape.members or 1) * shape.features)


@LAYERS.register(LayerNorm)
def layer_norm(options: LayerNorm, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(..., F) normalised features."""
    (value,) = inputs
    flat = np.ascontiguousarray(value.array).reshape(-1, value.array.shape[-1])
    result = core.normalize(flat, options.epsilon).reshape(value.array.shape)
    if options.affine:
        result = result * arrays["scale"] + arrays["shift"]
    return Value(result, value.mask)
