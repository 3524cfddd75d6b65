"""SARL: the value network with attention over people, as layers of irsim.

A person and the robot together are a joint state of 13 numbers. ``mlp1`` embeds each joint state, ``mlp2`` makes the
features of a person of it, and ``attention`` scores it, beside the mean of all if there is a global state. The
features, weighted by their scores, and the 6 numbers of the robot itself go through ``mlp3``, which returns the value.

References:
    Chen, Liu, Kreiss, Alahi: Crowd-Robot Interaction: Crowd-aware Robot Navigation with Attention-based Deep
    Reinforcement Learning (ICRA 2019), section III.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic
from irsim.policies.networks.document import PolicyDocument
from irsim.policies.networks.errors import PolicyFileError, flaw
from irsim.policies.networks.network import Network, check_network, read_document
from irsim.policies.networks.parts.robot import Heading
from irsim.policies.networks.values import Array

__all__ = ["ORDER", "PERCEPTRONS", "joint_state_parts", "sarl_network"]

PERCEPTRONS = {"mlp1": "embed", "mlp2": "features", "attention": "score", "mlp3": "value"}
"""Prefix of the weights -> stem of the labels of the layers."""
ORDER = (("x", "y", "vx", "vy", "radius", "distance", "radii"), 6, 13)
"""Numbers of a person, which follow the robot's; count of the robot's numbers, and of both together."""
_FIX = "give weights named mlp1.0.weight, mlp1.0.bias, mlp1.2.weight, … of the perceptrons " + ", ".join(PERCEPTRONS)


@dataclass(frozen=True)
class _Perceptron:
    """Weights (inputs, outputs) and biases (outputs) of linear layers with ReLU between them."""

    layers: tuple[tuple[Array, Array], ...]

    @property
    def inputs(self) -> int:
        return int(self.layers[0][0].shape[0])

    @property
    def outputs(self) -> int:
        return int(self.layers[-1][0].shape[1])


def joint_state_parts(neighbors: int, *, heading: Heading = "zero", range: float | None = None) -> list[dict[str, Any]]:
    """The parts of an observation that together are the joint states with up to ``neighbors`` people.

    Args:
        neighbors: Largest number of people.
        heading: Meaning of the third number.
        range: Gap between bounding circles beyond which people are not seen [m]; None sees everyone.
    """
    people = {
        "name": "neighbors", "label": "people", "count": neighbors, "range": range, "features": list(ORDER[0]),
        "frame": "goal", "relative_velocity": False, "distance_max": 1.0, "speed_max": 1.0, "radius_max": 1.0,
        "clip": False,
    }  # fmt: skip
    return [{"name": "self_state", "label": "self", "heading": heading}, people]


def sarl_network(
    weights: Mapping[str, Any],
    *,
    lookahead: Mapping[str, Any],
    neighbors: int = 10,
    range: float | None = None,
    heading: Heading | None = None,
    decision_dt: float | None = 0.25,
    card: Mapping[str, Any] | None = None,
    source: str = "weights",
) -> Network:
    """A network of the weights of SARL, named as in its published code.

    Args:
        weights: ``mlp1.0.weight`` (outputs, inputs), ``mlp1.0.bias`` (outputs), … of the four perceptrons. Whether
            there is a global state follows from their shapes.
        lookahead: Keys of :class:`irsim.policies.networks.lookahead.Lookahead`.
        neighbors: Number of people that it sees, the nearest ones.
        range: Gap between bounding circles beyond which people are not seen [m]; None sees everyone.
        heading: The third number of a joint state; None: 0, or the unwrapped heading of a unicycle, as published.
        decision_dt: Time between two decisions [s].
        card: Where the weights come from.
        source: Name of the weights for messages.

    Raises:
        PolicyFileError: The weights are not weights of SARL, or not finite; the error names every place.
    """
    problems = list(_weight_problems(weights))
    if problems:
        raise PolicyFileError(source, problems, _FIX)
    parts = {name: _perceptron(weights, name) for name in PERCEPTRONS}
    problems = list(_shape_problems(parts))
    if problems:
        raise PolicyFileError(source, problems, _FIX)
    unicycle = dict(lookahead.get("moves", {})).get("kind") == "unicycle"
    turned = heading or ("unwrapped" if unicycle else "zero")
    made = _Layers()
    made.add("concat", "joint", ["self", "people"])
    embedded = made.perceptron("embed", parts["mlp1"], "joint", last="relu")
    features = made.perceptron("features", parts["mlp2"], embedded)
    attended = embedded
    if parts["attention"].inputs == 2 * parts["mlp1"].outputs:
        made.add("pool", "mean", [embedded], method="mean")
        attended = made.add("concat", "beside_mean", [embedded, "mean"])
    score = made.perceptron("score", parts["attention"], attended)
    made.add("score_pool", "crowd", [score, features], skip_zero=True)
    made.add("concat", "state", ["self", "crowd"])
    value = made.perceptron("value", parts["mlp3"], "state")
    data = {
        "layout": {"parts": joint_state_parts(neighbors, heading=turned, range=range)},
        "network": made.layers,
        "output": {"input": value, "returns": "control" if unicycle else "velocity"},
        "lookahead": dict(lookahead),
        "drives": ["diff"] if unicycle else None,
        "decision_dt": decision_dt,
        "card": dict(card or {}),
    }
    network = Network(read_document(PolicyDocument, data, source), made.arrays)
    check_network(network, source)
    return network


class _Layers:
    """Collects layers and their arrays."""

    def __init__(self) -> None:
        self.layers: list[dict[str, Any]] = []
        self.arrays: dict[str, Array] = {}

    def add(self, name: str, label: str, inputs: list[str], **options: Any) -> str:
        """Add a layer, and return its label."""
        self.layers.append({"name": name, "label": label, "inputs": inputs, **options})
        return label

    def perceptron(self, stem: str, given: _Perceptron, before: str, last: str = "none") -> str:
        """Add dense layers, and return the label of the last one."""
        for number, (weight, bias) in enumerate(given.layers):
            activation = "relu" if number + 1 < len(given.layers) else last
            before = self.add("dense", f"{stem}_{number}", [before], units=len(bias), activation=activation)
            self.arrays[f"{before}.w"], self.arrays[f"{before}.b"] = weight, bias
        return before


def _numbers(weights: Mapping[str, Any], name: str) -> list[int]:
    """The numbers of the layers of a perceptron, in order: 0, 2, 4, …; activations are the odd ones."""
    result = (key.split(".")[1] for key in weights if key.startswith(f"{name}.") and key.endswith(".weight"))
    return sorted(int(word) for word in result if word.isdecimal() and len(word) < 4)


def _perceptron(weights: Mapping[str, Any], name: str) -> _Perceptron:
    layers = []
    for number in _numbers(weights, name):
        weight, bias = (np.asarray(weights[f"{name}.{number}.{end}"]) for end in ("weight", "bias"))
        layers.append((np.ascontiguousarray(weight.T, dtype=np.float32), bias.astype(np.float32)))
    return _Perceptron(tuple(layers))


def _weight_problems(weights: Mapping[str, Any]) -> Iterator[Diagnostic]:
    """Problems of the names, the kinds and the shapes of single arrays."""
    known = set()
    for name in PERCEPTRONS:
        numbers = _numbers(weights, name)
        if numbers != list(range(0, 2 * len(numbers), 2)) or not numbers:
            given = ", ".join(map(str, numbers)) or "none"
            yield flaw(f"{name}.*.weight", "the layers of this perceptron are not all there", given, "0, 2, 4, …")
            continue
        for number in numbers:
            pair = f"{name}.{number}.weight", f"{name}.{number}.bias"
            known |= set(pair)
            yield from _pair_problems(weights, *pair)
    for key in sorted(set(weights) - known):
        yield flaw(clean(key, 100), "SARL has no such array, or not in this place")


def _pair_problems(weights: Mapping[str, Any], weight: str, bias: str) -> Iterator[Diagnostic]:
    if bias not in weights:
        yield flaw(bias, "this array is missing")
        return
    arrays = {name: np.asarray(weights[name]) for name in (weight, bias)}
    for name, array in arrays.items():
        if array.dtype.kind != "f":
            yield flaw(name, "weights are floating-point numbers", clean(str(array.dtype), 60))
        elif not np.isfinite(array).all():
            yield flaw(name, "this array has numbers that are not finite")
        elif np.abs(array, dtype=np.float64).max(initial=0.0) > np.finfo(np.float32).max:
            yield flaw(name, "this array has numbers that are too large for float32")
    w, b = arrays[weight], arrays[bias]
    if w.ndim != 2 or b.shape != w.shape[:1] or 0 in w.shape:
        yield flaw(weight, "the shapes do not fit", f"{w.shape} and {b.shape}", "(outputs, inputs) and (outputs)")


def _shape_problems(parts: Mapping[str, _Perceptron]) -> Iterator[Diagnostic]:
    """Perceptrons that do not fit together."""
    for name, given in parts.items():
        for number, ((_, bias), (weight, _)) in enumerate(zip(given.layers, given.layers[1:], strict=False)):
            if len(bias) != len(weight):
                where = f"{name}.{2 * number + 2}.weight"
                yield flaw(where, "takes what the layer before returns", str(len(weight)), str(len(bias)))
    embedded = parts["mlp1"].outputs
    wanted = {
        "mlp1": (ORDER[2],),
        "mlp2": (embedded,),
        "attention": (2 * embedded, embedded),
        "mlp3": (ORDER[1] + parts["mlp2"].outputs,),
    }
    for name, sizes in wanted.items():
        if parts[name].inputs not in sizes:
            allowed = " or ".join(map(str, sizes))
            yield flaw(f"{name}.0.weight", "has another number of inputs", str(parts[name].inputs), allowed)
    for name in ("attention", "mlp3"):
        if parts[name].outputs != 1:
            last = 2 * len(parts[name].layers) - 2
            yield flaw(f"{name}.{last}.weight", "returns one number", str(parts[name].outputs), "1")
