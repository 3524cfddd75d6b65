"""Computations that several layers share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.policies.networks.layers._options import Arrays
from irsim.policies.networks.values import Array, Value, apply

__all__ = ["Activation", "Gates", "activate", "gates_arrays", "gru_cell", "linear", "mask_of", "spread"]

Activation = Literal["none", "relu", "tanh", "sigmoid", "elu", "gelu", "gelu_tanh", "silu", "softmax"]
"""``gelu`` is the exact one with the error function, ``gelu_tanh`` its approximation; ``softmax`` is over features."""


def linear(x: Array, w: Array, b: Array) -> Array:
    """(..., O) ``x w + b`` of x (..., I), w (I, O), b (O,)."""
    flat = np.ascontiguousarray(x).reshape(-1, w.shape[0])
    result: Array = core.dense(flat, w, b).reshape(*x.shape[:-1], w.shape[1])
    return result


def activate(name: Activation, x: Array) -> Array:
    """The activation of (..., F) features."""
    if name == "none":
        return x
    if name != "softmax":
        return apply(name, x)
    result: Array = core.softmax(np.ascontiguousarray(x).reshape(-1, x.shape[-1])).reshape(x.shape)
    return result


def mask_of(inputs: Sequence[Value]) -> NDArray[np.bool_] | None:
    """(B, K) members that are present in all sets among the inputs; None if all are vectors."""
    masks = [value.mask for value in inputs if value.mask is not None]
    return np.logical_and.reduce(masks) if masks else None


def spread(value: Value, members: int) -> Array:
    """(B, K, F) array of a set, or of a vector that each member gets."""
    if value.mask is not None:
        return value.array
    rows, features = value.array.shape
    return np.broadcast_to(value.array[:, None], (rows, members, features))


class Gates(NamedTuple):
    """Arrays of a gated recurrent unit with U units: columns of the reset gate, the update gate, the new state."""

    input_weights: Array
    input_bias: Array
    state_weights: Array
    state_bias: Array

    @classmethod
    def of(cls, arrays: Arrays, suffix: str = "") -> Gates:
        """The arrays of a layer."""
        return cls(*(arrays[name + suffix] for name in ("wx", "bx", "wh", "bh")))


def gates_arrays(features: int, units: int, suffix: str = "") -> dict[str, tuple[int, ...]]:
    """Shapes of the arrays of a gated recurrent unit."""
    wide = 3 * units
    shapes = {"wx": (features, wide), "bx": (wide,), "wh": (units, wide), "bh": (wide,)}
    return {name + suffix: shape for name, shape in shapes.items()}


def gru_cell(projected: Array, state: Array, gates: Gates) -> Array:
    """One step of a gated recurrent unit, in the form of PyTorch.

    r = s(Wr x + br + Ur h + cr), z = s(Wz x + bz + Uz h + cz), n = tanh(Wn x + bn + r (Un h + cn)),
    h' = (1 - z) n + z h.

    Args:
        projected: (B, 3 U) input times input weights plus bias.
        state: (B, U) state h.
        gates: The arrays.

    Returns:
        (B, U) new state.

    References:
        Cho et al.: Learning Phrase Representations using RNN Encoder-Decoder (2014).
    """
    units = state.shape[1]
    inner = linear(state, gates.state_weights, gates.state_bias)
    both = apply("sigmoid", projected[:, : 2 * units] + inner[:, : 2 * units])
    reset, update = both[:, :units], both[:, units:]
    new = apply("tanh", projected[:, 2 * units :] + reset * inner[:, 2 * units :])
    result: Array = (1 - update) * new + update * state
    return result
