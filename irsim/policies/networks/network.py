"""Networks in memory: a document and its arrays, what their layers need and compute, and whether all fits together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pydantic import BaseModel, ValidationError

from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic, Path, suggestion
from irsim.options.registry import KINEMATICS
from irsim.policies.networks.document import PolicyDocument, PolicyHead
from irsim.policies.networks.errors import LIMITS, Limits, PolicyFileError, flaw
from irsim.policies.networks.layers._options import LAYERS, LayerOptions, Plan, ShapeError
from irsim.policies.networks.layout import layout_shapes
from irsim.policies.networks.values import Array, Shape, Value, sides
from irsim.scenario.file_kind import explained
from irsim.scenario.yaml.document import Document

__all__ = [
    "FIX",
    "GraphPlan",
    "Network",
    "check_network",
    "output_problems",
    "plan_graph",
    "read_document",
    "run_graph",
]


@dataclass(frozen=True)
class GraphPlan:
    """Needs and results of a network.

    Attributes:
        shapes: Shape of each part and layer by its label.
        arrays: Name -> shape of each array.
        positive: Names of arrays whose numbers must be positive.
        memory: Label of each layer that remembers -> how many numbers for each robot.
        work: Multiplications for one robot, roughly.
        numbers: Numbers that all layers return for one robot.
        problems: Its problems; the rest is incomplete if there are any.
    """

    shapes: dict[str, Shape]
    arrays: dict[str, tuple[int, ...]]
    positive: frozenset[str]
    memory: dict[str, int]
    work: int
    numbers: int
    problems: tuple[Diagnostic, ...]

    @property
    def parameters(self) -> int:
        """Number of numbers in all arrays."""
        return sum(math.prod(shape) for shape in self.arrays.values())


def plan_graph(parts: Mapping[str, Shape], layers: Sequence[LayerOptions]) -> GraphPlan:
    """Check that layers fit together.

    Args:
        parts: Shapes of what is observed, by label.
        layers: The layers in the order in which they run.
    """
    shapes, arrays, memory = dict(parts), {}, {}
    positive: set[str] = set()
    problems: list[Diagnostic] = []
    broken: set[str] = set()
    work = numbers = 0
    for index, layer in enumerate(layers):
        where = ("network", index)
        if layer.label in shapes or layer.label in broken:
            problems.append(flaw((*where, "label"), "this name is taken by a part or an earlier layer", layer.label))
            continue
        plan = _plan_one(layer, shapes, where, broken, problems)
        if plan is None:
            broken.add(layer.label)
            continue
        shapes[layer.label] = plan.output
        arrays.update({f"{layer.label}.{name}": shape for name, shape in plan.arrays.items()})
        positive.update(f"{layer.label}.{name}" for name in plan.positive)
        work += plan.work
        numbers += plan.output.features * (plan.output.members or 1)
        if plan.memory:
            memory[layer.label] = plan.memory
    return GraphPlan(shapes, arrays, frozenset(positive), memory, work, numbers, tuple(problems))


def _plan_one(
    layer: LayerOptions, shapes: Mapping[str, Shape], where: Path, broken: set[str], problems: list[Diagnostic]
) -> Plan | None:
    """The plan of a layer; None if it cannot be made, with the reasons in ``problems``."""
    unknown = [name for name in layer.inputs if name not in shapes and name not in broken]
    for name in unknown:
        near = suggestion(name, shapes, "name a part or an earlier layer")
        problems.append(flaw((*where, "inputs"), f"no part and no earlier layer has this name; {near}", name))
    if unknown or any(name in broken for name in layer.inputs):
        return None
    inputs = [shapes[name] for name in layer.inputs]
    try:
        return layer.plan(inputs)
    except ShapeError as error:
        given = ", ".join(f"{name} ({shape})" for name, shape in zip(layer.inputs, inputs, strict=True))
        problems.append(flaw(where, f"{layer.name} {error}", given))
        return None


def run_graph(
    layers: Sequence[LayerOptions],
    arrays: Mapping[str, Mapping[str, Array]],
    observed: Mapping[str, Value],
    memory: Mapping[str, Array],
    wanted: str,
) -> Value:
    """Compute a network for B robots. Row b of the result depends on row b of what is observed alone, bit for bit.

    Args:
        layers: Layers that :func:`plan_graph` has accepted.
        arrays: Label of a layer -> its arrays, all of one type.
        observed: Label of a part -> its value, of the same type.
        memory: Label of a layer that remembers -> (B, M) of the last decision, replaced by this one's.
        wanted: Label of the result.

    Returns:
        The value of that label.
    """
    values = dict(observed)
    for layer in layers:
        feature = LAYERS.get(layer.name)
        assert feature is not None
        assert feature.function is not None
        inputs = [values[name] for name in layer.inputs]
        values[layer.label] = feature.function(layer, inputs, arrays.get(layer.label, {}), memory.get(layer.label))
    return values[wanted]


FIX = "correct what is named; irsim.policies.networks.save_network writes files of this format"


@dataclass(frozen=True)
class Network:
    """A network of the layers of irsim.

    Attributes:
        document: Its observations and layers, and the meaning of its result.
        arrays: ``<label>.<array>`` -> array of the type that the document says.
    """

    document: PolicyDocument
    arrays: Mapping[str, Array] = field(default_factory=dict)

    def by_layer(self) -> dict[str, dict[str, Array]]:
        """Label of a layer -> its arrays by name."""
        result: dict[str, dict[str, Array]] = {}
        for key, array in self.arrays.items():
            label, _, name = key.partition(".")
            result.setdefault(label, {})[name] = array
        return result


def read_document(model: type[BaseModel], data: Any, source: str) -> Any:
    """Validate the document of a policy.

    Args:
        model: Its model.
        data: Its data.
        source: Name of the file for messages.

    Raises:
        PolicyFileError: It is not valid; the error lists every problem.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        problems = explained(error, Document(data), model)
    except RecursionError:
        problems = [flaw("", "the document is nested too deeply")]
    raise PolicyFileError(source, problems, FIX)


def check_network(network: Network, source: str, limits: Limits = LIMITS) -> GraphPlan:
    """Check that layers, arrays and output of a network fit together.

    Args:
        network: The network.
        source: Name of its file for messages.
        limits: How large it may be.

    Raises:
        PolicyFileError: They do not; the error lists every problem.
    """
    document = network.document
    if len(document.network) > limits.layers:
        many = flaw("network", "too many layers", str(len(document.network)), f"up to {limits.layers}")
        raise PolicyFileError(source, [many], FIX)
    plan = plan_graph(layout_shapes(document.layout), document.network)
    problems = list(plan.problems)
    if not problems:
        problems += _size_problems(plan, limits)
        problems += _value_problems(document, plan, limits) if document.lookahead else []
        problems += [] if document.lookahead else output_problems(document, plan.shapes)
    if not problems:
        problems += _array_problems(network.arrays, plan, np.dtype(document.precision))
    if problems:
        raise PolicyFileError(source, problems, FIX)
    return plan


def _size_problems(plan: GraphPlan, limits: Limits) -> Iterator[Diagnostic]:
    sizes = (
        ("parameters", plan.parameters, limits.parameters),
        ("multiplications for each decision", plan.work, limits.work),
        ("numbers that layers return for a robot", plan.numbers + sum(plan.memory.values()), limits.numbers),
    )
    for what, size, most in sizes:
        if size > most:
            yield flaw("network", f"too many {what}", str(size), f"up to {most}")


def _value_problems(document: PolicyDocument, plan: GraphPlan, limits: Limits) -> Iterator[Diagnostic]:
    """Problems of a network whose result is the value of a state."""
    assert document.lookahead is not None
    label, shape = document.output.input, plan.shapes.get(document.output.input)
    if shape is None:
        yield _unknown_input(label, plan.shapes)
    elif shape.members is not None or shape.features != 1:
        yield flaw(("output", "input"), "a value is one number", f"{label} ({shape})", "a vector of 1")
    if plan.memory:
        yield flaw("network", "a network with lookahead remembers nothing", ", ".join(plan.memory))
    work = plan.work * document.lookahead.moves.count
    if work > limits.work:
        yield flaw(
            ("lookahead", "moves"), "too many multiplications for each decision", str(work), f"up to {limits.work}"
        )


def output_problems(head: PolicyHead, shapes: Mapping[str, Shape]) -> Iterator[Diagnostic]:
    """Problems of the output of a network whose values have these shapes."""
    output = head.output
    shape = shapes.get(output.input)
    if shape is None:
        yield _unknown_input(output.input, shapes)
        return
    if shape.members is not None:
        yield flaw(("output", "input"), "the result is a vector, not a set", f"{output.input} ({shape})")
        return
    columns = shape.features if output.choices is None else len(output.choices[0])
    if output.choices is not None and len(output.choices) != shape.features:
        yield flaw(("output", "choices"), "one for each number", str(len(output.choices)), str(shape.features))
    if output.low is not None and len(output.low) != shape.features:
        yield flaw(("output", "low"), "one number for each output", str(len(output.low)), str(shape.features))
    if output.returns == "velocity" and columns != 2:
        yield flaw("output", "a velocity has 2 numbers", str(columns))
    elif output.returns == "control" and columns > 3:
        yield flaw("output", "drives have up to 3 controls", str(columns))
    elif output.returns == "control":
        for drive in head.drives or ():
            known = KINEMATICS.get(drive)
            needed = len(getattr(known.options, "control_rows", ())) if known is not None else 0
            if columns < needed:
                yield flaw("output", f"{drive} has {needed} controls", str(columns))


def _unknown_input(label: str, shapes: Mapping[str, Shape]) -> Diagnostic:
    return flaw(("output", "input"), "no part and no layer has this name", label, ", ".join(list(shapes)[-5:]))


def _array_problems(arrays: Mapping[str, Array], plan: GraphPlan, dtype: np.dtype[Any]) -> Iterator[Diagnostic]:
    for name, shape in plan.arrays.items():
        array = arrays.get(name)
        if array is None:
            yield flaw(name, "this array is missing", allowed=f"{dtype} of shape {sides(shape)}")
        elif array.shape != shape:
            yield flaw(name, "this array has another shape", sides(array.shape), sides(shape))
        elif array.dtype != dtype:
            yield flaw(name, "this array has another type", str(array.dtype), str(dtype))
        elif not np.isfinite(array).all():
            yield flaw(name, "this array has numbers that are not finite")
        elif name in plan.positive and not (array > 0).all():
            yield flaw(name, "all numbers of this array must be positive", str(array.min()))
    for name in arrays.keys() - plan.arrays.keys():
        yield flaw(clean(name, 100), "no layer has such an array")
