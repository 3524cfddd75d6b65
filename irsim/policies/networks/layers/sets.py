"""Layers over the members of a set: pools and attention."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

import irsim._core as core
from irsim.options.units import Bool, Integer
from irsim.policies.networks.layers._options import (
    LAYERS,
    Arrays,
    LayerOptions,
    Plan,
    ShapeError,
    Units,
    linear,
    mask_of,
    only,
    same_set,
)
from irsim.policies.networks.values import Array, Shape, Value, add_in_order


class Pool(LayerOptions):
    """Maximum, mean or sum over the members that are present; zeros for an empty set."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "pool", "label": "crowd", "inputs": ["each"], "method": "max"}]
    }

    name: Literal["pool"] = "pool"
    method: Literal["max", "mean", "sum"] = "max"
    """The number kept of each feature."""

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


class ScorePool(LayerOptions):
    """The mean of the members of the second input, with the exponentials of the scores in the first as weights.

    Source: Chen, Liu, Kreiss, Alahi: Crowd-Robot Interaction (2019), the attentive pooling.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "score_pool", "label": "crowd", "inputs": ["score", "each"]}]
    }

    name: Literal["score_pool"] = "score_pool"
    skip_zero: Bool = False
    """Whether members whose score is exactly 0 count as absent, as in the published code of SARL."""

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """A vector of the features of the second input."""
        if len(inputs) != 2 or None in (inputs[0].members, inputs[1].members) or inputs[0].features != 1:
            raise ShapeError("takes a set of scores, one for each member, and a set")
        members = same_set(inputs) or 0
        return Plan(Shape(inputs[1].features), {}, members * (20 + inputs[1].features))


@LAYERS.register(ScorePool)
def score_pool(options: ScorePool, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(B, F) of (B, K, 1) scores and (B, K, F) sets."""
    scores, members = inputs[0].array[:, :, 0], inputs[1]
    mask = mask_of(inputs)
    assert mask is not None
    if options.skip_zero:
        mask = mask & (scores != 0)
    weights = core.softmax(np.ascontiguousarray(scores), np.ascontiguousarray(mask).view(np.uint8))
    return Value(add_in_order(np.moveaxis(weights[:, :, None] * members.present(), 1, 0)))


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
