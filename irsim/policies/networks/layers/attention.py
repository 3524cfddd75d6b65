"""``attention``: scaled dot-product attention over the members of a set."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.options.units import Integer
from irsim.policies.networks.layers._linear import linear
from irsim.policies.networks.layers._options import LAYERS, Arrays, LayerOptions, Plan, ShapeError, Units
from irsim.policies.networks.values import Array, Shape, Value


class Attention(LayerOptions):
    """Attention of a vector or of each member of a set over the members of the last input that are present.

    One input attends to itself. With two inputs, the first asks and the second, a set, answers.

    Arrays: `wq`, `wk`, `wv` (features, units), `wo` (units, units) and `bq`, `bk`, `bv`, `bo` (units). A head is a
    slice of the units. If no member is present, the result is `bo`.

    Source: Vaswani et al.: Attention Is All You Need (2017), section 3.2.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "attention", "label": "a", "inputs": ["self", "each"], "units": 32, "heads": 4}]
    }

    name: Literal["attention"] = "attention"
    units: Units
    """Number of outputs."""
    heads: Annotated[Integer, Field(ge=1, le=256)] = 1
    """Number of heads; it divides the units."""

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """As many vectors as ask."""
        if len(inputs) > 2 or inputs[-1].members is None:
            raise ShapeError("takes a set, or what asks and a set")
        if self.units % self.heads:
            raise ShapeError(f"has {self.heads} heads, which do not divide its {self.units} units")
        asks, answers, units = inputs[0], inputs[-1], self.units
        arrays: dict[str, tuple[int, ...]] = {
            "wq": (asks.features, units),
            "wk": (answers.features, units),
            "wv": (answers.features, units),
            "wo": (units, units),
            **dict.fromkeys(("bq", "bk", "bv", "bo"), (units,)),
        }
        queries, keys = asks.members or 1, answers.members or 1
        projections = queries * (asks.features + units) * units + 2 * keys * answers.features * units
        return Plan(Shape(units, asks.members), arrays, projections + 2 * queries * keys * (units + 20 * self.heads))


@LAYERS.register(Attention)
def attention(options: Attention, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(B, U) or (B, Q, U) answers."""
    asks, answers = inputs[0], inputs[-1]
    asking = asks.array if asks.mask is not None else asks.array[:, None]
    query = linear(asking, arrays["wq"], arrays["bq"])
    key, value = (linear(answers.present(), arrays[w], arrays[b]) for w, b in (("wk", "bk"), ("wv", "bv")))
    mixed = core.attention(query, key, value, answers.flags(), options.heads)
    result = linear(mixed, arrays["wo"], arrays["bo"])
    return Value(result, asks.mask) if asks.mask is not None else Value(result[:, 0])
