"""Options that all layers have in common, and what a layer says about itself before it runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, NamedTuple

from pydantic import Field

from irsim.options.base import Options
from irsim.options.registry import Registry
from irsim.options.units import Integer
from irsim.policies.networks.parts._options import Label
from irsim.policies.networks.values import Array, Shape

__all__ = ["LAYERS", "Arrays", "LayerOptions", "Plan", "ShapeError", "Units", "only", "same_set", "vector"]

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
