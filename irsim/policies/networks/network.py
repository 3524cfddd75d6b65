"""Networks in memory: a document and its arrays, and whether they fit together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pydantic import BaseModel, ValidationError

from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic
from irsim.options.registry import KINEMATICS
from irsim.policies.networks.document import OutputOptions, PolicyDocument, PolicyHead
from irsim.policies.networks.errors import LIMITS, Limits, PolicyFileError, flaw
from irsim.policies.networks.graph import GraphPlan, plan_graph
from irsim.policies.networks.layout import layout_shapes
from irsim.policies.networks.values import Array, Shape
from irsim.scenario.file_kind import explained
from irsim.scenario.yaml.document import Document

__all__ = ["FIX", "Network", "check_network", "output_problems", "read_document"]

FIX = "correct what is named; irsim.policies.networks.save_network writes files of this format"


@dataclass(frozen=True)
class Network:
    """A network of the layers of irsim.

    Attributes:
        document: What it observes, its layers, what its result means.
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
    """What is wrong with a network whose result is the value of a state."""
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
    """What is wrong with the output of a network whose values have these shapes."""
    output = head.output
    shape = shapes.get(output.input)
    if shape is None:
        yield _unknown_input(output.input, shapes)
        return
    if shape.members is not None:
        yield flaw(("output", "input"), "the result is a vector, not a set", f"{output.input} ({shape})")
        return
    columns = _columns(output, shape.features)
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


def _columns(output: OutputOptions, features: int) -> int:
    return features if output.choices is None else len(output.choices[0])


def _array_problems(arrays: Mapping[str, Array], plan: GraphPlan, dtype: np.dtype[Any]) -> Iterator[Diagnostic]:
    for name, shape in plan.arrays.items():
        array = arrays.get(name)
        if array is None:
            yield flaw(name, "this array is missing", allowed=f"{dtype} of shape {_sides(shape)}")
        elif array.shape != shape:
            yield flaw(name, "this array has another shape", _sides(array.shape), _sides(shape))
        elif array.dtype != dtype:
            yield flaw(name, "this array has another type", str(array.dtype), str(dtype))
        elif not np.isfinite(array).all():
            yield flaw(name, "this array has numbers that are not finite")
        elif name in plan.positive and not (array > 0).all():
            yield flaw(name, "all numbers of this array must be positive", str(array.min()))
    for name in arrays.keys() - plan.arrays.keys():
        yield flaw(clean(name, 100), "no layer has such an array")


def _sides(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape)) or "one number"
