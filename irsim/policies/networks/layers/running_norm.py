"""``running_norm``: features by mean and deviation that training has measured."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from irsim.options.units import Number
from irsim.policies.networks.layers._options import LAYERS, Arrays, LayerOptions, Plan, only
from irsim.policies.networks.values import Array, Shape, Value


class RunningNorm(LayerOptions):
    """Subtract the mean and divide by the standard deviation that training has measured, then clip.

    Arrays: `mean` and `std` (features); `std` is positive.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "running_norm", "label": "n", "inputs": ["goal"]}]}

    name: Literal["running_norm"] = "running_norm"
    clip: Annotated[Number, Field(gt=0)] | None = 10.0
    """Largest result and, negative, the smallest; null does not clip."""

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """The shape of the input."""
        shape = only(inputs)
        arrays: dict[str, tuple[int, ...]] = {"mean": (shape.features,), "std": (shape.features,)}
        return Plan(shape, arrays, 2 * (shape.members or 1) * shape.features, positive=("std",))


@LAYERS.register(RunningNorm)
def running_norm(options: RunningNorm, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(..., F) normalised features."""
    (value,) = inputs
    result = (value.array - arrays["mean"]) / arrays["std"]
    return Value(result if options.clip is None else np.clip(result, -options.clip, options.clip), value.mask)
