"""Networks in memory: a document and its arrays, and whether they fit together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pydantic import BaseModel, ValidationError

from irsim.common.text import clean
from irsim.diagnostics.diagnostic import format_path
from irsim.options.registry import KINEMATICS
from irsim.policies.networks.document import OutputOptions, PolicyDocument, PolicyHead
from irsim.policies.networks.errors import PolicyFileError, Problem
from irsim.policies.networks.graph import GraphPlan, plan_graph
from irsim.policies.networks.layout import layout_shapes
from irsim.policies.networks.limits import LIMITS, Limits
from irsim.policies.networks.values import Array, Shape

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
        found: dict[str, dict[str, Array]] = {}
        for key, array in self.arrays.items():
            label, _, name = key.partition(".")
            found.setdefault(label, {})[name] = array
        return found


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
        problems = [_problem(item) for item in error.errors(include_url=False)]
    except RecursionError:
        problems = [Problem("", "the document is nested too deeply")]
    raise PolicyFileError(source, problems, FIX)


def _problem(item: Any) -> Problem:
    details = item.get("ctx", {})
    message = str(item["msg"]).removeprefix("Value error, ")
    if item["type"] == "extra_forbidden":
        message = "there is no such key"
    fix = details.get("fix")
    allowed = details.get("allowed", details.get("expected", ""))
    allowed = ", ".join(map(str, allowed)) if isinstance(allowed, (list, tuple)) else str(allowed)
    given = "" if item["type"] in ("missing", "extra_forbidden") else _short(item["input"])
    where = format_path(item["loc"])
    return Problem(where, clean(message + (f" ({fix})" if fix else ""), 300), given, clean(allowed, 300))


def _short(value: Any) -> str:
    if isinstance(value, (dict, list)):
        return f"{type(value).__name__} of {len(value)}"
    return clean(repr(value), 60)


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
        many = Problem("network", "too many layers", str(len(document.network)), f"up to {limits.layers}")
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


def _size_problems(plan: GraphPlan, limits: Limits) -> Iterator[Problem]:
    sizes = (
        ("parameters", plan.parameters, limits.parameters),
        ("multiplications for each decision", plan.work, limits.work),
        ("numbers that layers return for a robot", plan.numbers + sum(plan.memory.values()), limits.numbers),
    )
    for what, size, most in sizes:
        if size > most:
            yield Problem("network", f"too many {what}", str(size), f"up to {most}")


def _value_problems(document: PolicyDocument, plan: GraphPlan, limits: Limits) -> Iterator[Problem]:
    """What is wrong with a network whose result is the value of a state."""
    assert document.lookahead is not None
    label, shape = document.output.input, plan.shapes.get(document.output.input)
    if shape is None:
        yield Problem("output.input", "no part and no layer has this name", label, ", ".join(list(plan.shapes)[-5:]))
    elif shape.members is not None or shape.features != 1:
        yield Problem("output.input", "a value is one number", f"{label} ({shape})", "a vector of 1")
    if plan.memory:
        yield Problem("network", "a network with lookahead remembers nothing", ", ".join(plan.memory))
    work = plan.work * document.lookahead.moves.count
    if work > limits.work:
        yield Problem(
            "lookahead.moves", "too many multiplications for each decision", str(work), f"up to {limits.work}"
        )


def output_problems(head: PolicyHead, shapes: Mapping[str, Shape]) -> Iterator[Problem]:
    """What is wrong with the output of a network whose values have these shapes."""
    output = head.output
    shape = shapes.get(output.input)
    if shape is None:
        yield Problem("output.input", "no part and no layer has this name", output.input, ", ".join(list(shapes)[-5:]))
        return
    if shape.members is not None:
        yield Problem("output.input", "the result is a vector, not a set", f"{output.input} ({shape})")
        return
    columns = _columns(output, shape.features)
    if output.choices is not None and len(output.choices) != shape.features:
        yield Problem("output.choices", "one for each number", str(len(output.choices)), str(shape.features))
    if output.low is not None and len(output.low) != shape.features:
        yield Problem("output.low", "one number for each output", str(len(output.low)), str(shape.features))
    if output.returns == "velocity" and columns != 2:
        yield Problem("output", "a velocity has 2 numbers", str(columns))
    elif output.returns == "control" and columns > 3:
        yield Problem("output", "drives have up to 3 controls", str(columns))
    elif output.returns == "control":
        for drive in head.drives or ():
            known = KINEMATICS.get(drive)
            needed = len(getattr(known.options, "control_rows", ())) if known is not None else 0
            if columns < needed:
                yield Problem("output", f"{drive} has {needed} controls", str(columns))


def _columns(output: OutputOptions, features: int) -> int:
    return features if output.choices is None else len(output.choices[0])


def _array_problems(arrays: Mapping[str, Array], plan: GraphPlan, dtype: np.dtype[Any]) -> Iterator[Problem]:
    for name, shape in plan.arrays.items():
        array = arrays.get(name)
        if array is None:
            yield Problem(name, "this array is missing", allowed=f"{dtype} of shape {_sides(shape)}")
        elif array.shape != shape:
            yield Problem(name, "this array has another shape", _sides(array.shape), _sides(shape))
        elif array.dtype != dtype:
            yield Problem(name, "this array has another type", str(array.dtype), str(dtype))
        elif not np.isfinite(array).all():
            yield Problem(name, "this array has numbers that are not finite")
        elif name in plan.positive and not (array > 0).all():
            yield Problem(name, "all numbers of this array must be positive", str(array.min()))
    for name in arrays.keys() - plan.arrays.keys():
        yield Problem(clean(name, 100), "no layer has such an array")


def _sides(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape)) or "one number"
