"""Networks as lists of layers: what they need, and what they compute."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from irsim.diagnostics.diagnostic import Diagnostic, Path, suggestion
from irsim.policies.networks.errors import flaw
from irsim.policies.networks.layers._options import LAYERS, LayerOptions, Plan, ShapeError
from irsim.policies.networks.values import Array, Shape, Value

__all__ = ["GraphPlan", "plan_graph", "run_graph"]


@dataclass(frozen=True)
class GraphPlan:
    """What a network needs and makes.

    Attributes:
        shapes: Shape of each part and layer by its label.
        arrays: Name -> shape of each array.
        positive: Names of arrays whose numbers must be positive.
        memory: Label of each layer that remembers -> how many numbers for each robot.
        work: Multiplications for one robot, roughly.
        numbers: Numbers that all layers return for one robot.
        problems: What is wrong; the rest is incomplete if there are any.
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
        total = 0
        for shape in self.arrays.values():
            count = 1
            for side in shape:
                count *= side
            total += count
        return total


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
        memory: Label of a layer that remembers -> (B, M) of the last decision, replaced by those of this one.
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
