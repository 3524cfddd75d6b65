"""Layers that treat each member of a set like a vector: linear ones, activations, norms, choices of features."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

import irsim._core as core
from irsim.options.units import Bool, Count, Integer, Number
from irsim.policies.networks.layers._options import (
    LAYERS,
    Activation,
    Arrays,
    LayerOptions,
    Plan,
    ShapeError,
    Units,
    activate,
    linear,
    mask_of,
    only,
    same_set,
    spread,
)
from irsim.policies.networks.values import Array, Shape, Value, add_in_order


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


class Add(LayerOptions):
    """The sum of inputs with equally many features; vectors are added to each member of sets."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "add", "label": "sum", "inputs": ["h1", "h2"]}]}

    name: Literal["add"] = "add"

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """As many features; a set if one of the inputs is."""
        members = same_set(inputs)
        sizes = sorted({shape.features for shape in inputs})
        if len(sizes) > 1:
            raise ShapeError(f"adds inputs with equally many features, not {' and '.join(map(str, sizes))}")
        return Plan(Shape(sizes[0], members), {}, len(inputs) * (members or 1) * sizes[0])


@LAYERS.register(Add)
def add(options: Add, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(..., F) sum."""
    mask = mask_of(inputs)
    if mask is None:
        return Value(add_in_order(value.array for value in inputs))
    return Value(add_in_order(spread(value, mask.shape[1]) for value in inputs), mask)


class Concat(LayerOptions):
    """The features of the inputs one after the other. Members of sets get the features of vectors, too."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "concat", "label": "all", "inputs": ["goal", "own"]}]
    }

    name: Literal["concat"] = "concat"

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """All features; a set if one of the inputs is."""
        members = same_set(inputs)
        return Plan(Shape(sum(shape.features for shape in inputs), members), {}, 0)


@LAYERS.register(Concat)
def concat(options: Concat, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(..., F) all features."""
    mask = mask_of(inputs)
    if mask is None:
        return Value(np.concatenate([value.array for value in inputs], axis=1))
    return Value(np.concatenate([spread(value, mask.shape[1]) for value in inputs], axis=2), mask)


class Flatten(LayerOptions):
    """The features of all members one after the other; absent members are zeros."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "flatten", "label": "f", "inputs": ["neighbors"]}]}

    name: Literal["flatten"] = "flatten"

    def plan(self, inputs: Sequence[Shape]) -> Plan:
        """A vector of all features of all members."""
        shape = only(inputs)
        if shape.members is None:
            raise ShapeError(f"takes a set, not a vector of {shape}")
        return Plan(Shape(shape.members * shape.features), {}, 0)


@LAYERS.register(Flatten)
def flatten(options: Flatten, inputs: Sequence[Value], arrays: Arrays, memory: Array | None) -> Value:
    """(B, K F) of (B, K, F)."""
    (value,) = inputs
    return Value(value.flat())


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
