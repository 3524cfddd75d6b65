"""Options that all layers have in common, the plan of a layer before it runs, and shared computations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

import irsim._core as core
from irsim.options.base import Options
from irsim.options.registry import Registry
from irsim.options.units import Integer
from irsim.policies.networks.parts._options import Label
from irsim.policies.networks.values import Array, Shape, Value, apply

__all__ = [
    "LAYERS", "Activation", "Arrays", "Gates", "LayerOptions", "Plan", "ShapeError", "Units", "activate",
    "gates_arrays", "gru_cell", "linear", "mask_of", "only", "same_set", "spread", "vector",
]  # fmt: skip

LAYERS = Registry(
    "layer", "irsim.policies.networks.layers", "irsim.network_layers", families=("recurrent", "sets", "vectors")
)
"""Layers of networks."""
Arrays = Mapping[str, Array]
"""Arrays of a layer, by their names in :class:`Plan`."""
Units = Annotated[Integer, Field(ge=1, le=65536)]
"""Number of outputs of a layer."""


class Plan(NamedTuple):
    """Output and needs of a layer for inputs of certain shapes.

    Attributes:
        output: Shape of what it returns.
        arrays: Name -> shape of the arrays that it needs; the file has them as ``<label>.<name>``.
        work: Multiplications for one robot, roughly.
        memory: Numbers that it remembers for each robot from one decision to the next.
        positive: Names of arrays whose numbers must be positive.
    """

    output: Shape
    arrays: dict[str, tuple[int, ...]]
    work: int
    memory: int = 0
    positive: tuple[str, ...] = ()


class ShapeError(Exception):
    """A layer cannot take inputs of these shapes; the message says which it can."""


class LayerOptions(Options):
    """Keys that every layer takes."""

    name: str
    """Name of the layer."""
    label: Label
    """Name of its result, and of its arrays in the file: `<label>.<array>`."""
    inputs: Annotated[list[Label], Field(min_length=1, max_length=64)]
    """Labels of parts and earlier layers."""

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """The plan of the layer for its inputs.

        Raises:
            ShapeError: It cannot take these inputs.
        """
        raise NotImplementedError


def only(inputs: Sequence[Shape]) -> Shape:
    """The one input of a layer that takes one.

    Raises:
        ShapeError: There are several.
    """
    if len(inputs) != 1:
        raise ShapeError(f"takes 1 input, not {len(inputs)}; put a concat layer before it")
    return inputs[0]


def vector(inputs: Sequence[Shape]) -> Shape:
    """The one input of a layer that takes a vector.

    Raises:
        ShapeError: There are several inputs, or it is a set.
    """
    shape = only(inputs)
    if shape.members is not None:
        raise ShapeError(f"takes a vector, not a set of {shape}; put pool, flatten or gru before it")
    return shape


def same_set(inputs: Sequence[Shape]) -> int | None:
    """Number of members that all sets among the inputs have; None if all are vectors.

    Raises:
        ShapeError: The numbers differ.
    """
    sizes = {shape.members for shape in inputs if shape.members is not None}
    if len(sizes) > 1:
        raise ShapeError(f"takes sets with equal numbers of members, not {' and '.join(map(str, sorted(sizes)))}")
    return sizes.pop() if sizes else None


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
