"""``score_pool``: the mean of the members of a set, weighted by scores."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

import numpy as np

import irsim._core as core
from irsim.options.units import Bool
from irsim.policies.networks.layers._linear import mask_of
from irsim.policies.networks.layers._options import LAYERS, Arrays, LayerOptions, Plan, ShapeError, same_set
from irsim.policies.networks.values import Array, Shape, Value, add_in_order


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
