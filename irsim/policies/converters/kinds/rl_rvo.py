"""``rl_rvo``: the policy of RL-RVO, a recurrent network over reciprocal velocity obstacles."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import Field

from irsim.options.units import Integer, Meters, MetersPerSecond, Seconds
from irsim.policies.converters.convert import CONVERTERS, ConverterOptions, Weights
from irsim.policies.networks.document import FORMAT, VERSION, PolicyDocument
from irsim.policies.networks.network import Network, read_document
from irsim.policies.networks.values import Array, sides

_SELF, _CONE, _RESULT = 6, 8, 2
"""Numbers that the robot observes of itself and of each other one, and numbers that it decides."""
_ARRAYS = (("wx", "weight_ih"), ("bx", "bias_ih"), ("wh", "weight_hh"), ("bh", "bias_hh"))
_STRUCTURE = (
    "RL-RVO has a GRU over 8 numbers (weight_ih_l0 of 3 U x 8, also _reverse), a layer norm (ln.weight of 6 + U) and "
    "linear layers from 6 + U to 2 numbers (net_out.0.weight and so on)"
)


class RlRvo(ConverterOptions):
    """Weights of RL-RVO (Han et al. 2022): a state dictionary, a checkpoint, or the module of its authors.

    A GRU, forward or in both directions, reads the velocity obstacles of the others; the sum of its last states and
    what the robot knows of itself are normalized and pass linear layers with ReLU. The hyperbolic tangent of the two
    results times `acceler` is added to the velocity in the world frame, which every drive follows. Arrays are found by
    their shapes and by the ends of their names, such as `pi.rnn_reader.rnn_net.weight_ih_l0`. The authors' tests also
    round the two results to two decimals; this policy does not.
    """

    name: Literal["rl_rvo"] = "rl_rvo"
    acceler: Annotated[MetersPerSecond, Field(gt=0)] = 1.0
    """Largest change of vx and of vy in a decision; the authors train with 0.5 and test with 1."""
    margin: Annotated[Meters, Field(ge=0)] = 0.1
    """Added to the robot's own radius."""
    speed: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Desired speed; null is the largest speed of each robot. The authors' robots drive up to 1.5 m/s."""
    range: Annotated[Meters, Field(gt=0)] = 4.0
    """Others whose center is farther away are not seen."""
    count: Annotated[Integer, Field(ge=1, le=256)] = 5
    """Largest number of observed objects."""
    decision_dt: Annotated[Seconds, Field(gt=0)] | None = None
    """Time between two decisions; null decides in every step. The authors decide every 0.1 s."""


@CONVERTERS.register(RlRvo)
def rl_rvo(weights: Weights, options: RlRvo) -> Network:
    """The network of these weights.

    Raises:
        PolicyFileError: They are others; the message says what is missing, and what there is.
    """
    units = _units(weights)
    arrays, direction = _reader(weights, units)
    arrays["normed.scale"] = weights.take("the scale of the layer norm", _NORM_SCALES, [_SELF + units])
    arrays["normed.shift"] = weights.take("the shift of the layer norm", _NORM_SHIFTS, [_SELF + units])
    layers: list[dict[str, Any]] = [
        {"name": "gru", "label": "read", "inputs": ["rvo_cones"], "units": units, "direction": direction,
         "merge": "sum"},
        {"name": "concat", "label": "all", "inputs": ["rvo_self", "read"]},
        {"name": "layer_norm", "label": "normed", "inputs": ["all"]},
    ]  # fmt: skip
    before = "normed"
    chain = _linear_layers(weights, _SELF + units)
    for number, (weight, bias) in enumerate(chain):
        label, last = f"decision_{number}", number == len(chain) - 1
        activation = "none" if last else "relu"
        layers.append({"name": "dense", "label": label, "inputs": [before], "units": len(bias),
                       "activation": activation})  # fmt: skip
        arrays[f"{label}.w"], arrays[f"{label}.b"] = weight.T.copy(), bias
        before = label
    return Network(read_document(PolicyDocument, _document(options, layers, before), weights.source), arrays)


def _document(options: RlRvo, layers: list[dict[str, Any]], result: str) -> dict[str, Any]:
    cones = {"name": "rvo_cones", "count": options.count, "range": options.range, "margin": options.margin}
    return {
        "format": FORMAT,
        "version": VERSION,
        "layout": {"parts": [{"name": "rvo_self", "speed": options.speed, "margin": options.margin}, cones]},
        "network": layers,
        "output": {
            "input": result, "returns": "velocity", "frame": "world", "increment": True, "squash": "tanh",
            "low": [-options.acceler] * _RESULT, "high": [options.acceler] * _RESULT,
        },
        "decision_dt": options.decision_dt,
        "card": {
            "description": "RL-RVO: velocity changes from the reciprocal velocity obstacles of the neighbors",
            "notes": {"acceler": options.acceler, "margin": options.margin},
        },
    }  # fmt: skip


def _units(weights: Weights) -> int:
    """Width of the recurrent unit."""
    recurrent = weights.take("the weights of the GRU on its state", ["weight_hh_l0"], [None, None])
    rows, units = recurrent.shape
    if rows == 4 * units:
        raise weights.error("", f"the recurrent unit is an LSTM; {_STRUCTURE}", f"{rows} x {units}")
    if rows != 3 * units or units < 1:
        raise weights.error("", f"the recurrent unit is not a GRU; {_STRUCTURE}", f"{rows} x {units}", "3 U x U")
    return int(units)


def _reader(weights: Weights, units: int) -> tuple[dict[str, Array], str]:
    """The arrays of the GRU, and its direction."""
    backward = any(name.endswith("weight_ih_l0_reverse") for name in weights.arrays)
    shapes = {"weight_ih": [3 * units, _CONE], "weight_hh": [3 * units, units], "bias_ih": [3 * units],
              "bias_hh": [3 * units]}  # fmt: skip
    arrays = {}
    for ending, suffix in [("", ""), ("_back", "_reverse")] if backward else [("", "")]:
        for ours, theirs in _ARRAYS:
            result = weights.take(f"array {theirs} of the GRU", [f"{theirs}_l0{suffix}"], shapes[theirs])
            arrays[f"read.{ours}{ending}"] = result.T.copy() if result.ndim == 2 else result
    return arrays, "both" if backward else "forward"


_NORM_SCALES = ("ln.weight", "layer_norm.weight", "norm.weight")
_NORM_SHIFTS = ("ln.bias", "layer_norm.bias", "norm.bias")


def _linear_layers(weights: Weights, inputs: int) -> list[tuple[Array, Array]]:
    """Weights and biases of the linear layers that lead to the decision."""
    groups: dict[str, dict[int, Array]] = {}
    for name, array in weights.arrays.items():
        match = re.fullmatch(r"(?:(.*)\.)?(\d{1,4})\.weight", name)
        if match and array.ndim == 2:
            groups.setdefault(match.group(1) or "", {})[int(match.group(2))] = array
    fitting = [prefix for prefix, layers in groups.items() if _leads(layers, inputs)]
    if len(fitting) != 1:
        what = "no" if not fitting else "more than one"
        message = f"there is {what} sequence of linear layers from {inputs} to {_RESULT} numbers; {_STRUCTURE}"
        raise weights.error("", message, weights.listed())
    (prefix,) = fitting
    before = f"{prefix}." if prefix else ""
    result = []
    for number, weight in sorted(groups[prefix].items()):
        bias = weights.arrays.get(f"{before}{number}.bias")
        if bias is None or bias.shape != weight.shape[:1]:
            given = "none" if bias is None else sides(bias.shape)
            raise weights.error(f"{before}{number}.bias", "this bias does not fit", given, sides(weight.shape[:1]))
        result.append((weight, bias))
    return result


def _leads(layers: Mapping[int, Array], inputs: int) -> bool:
    shapes = [layers[number].shape for number in sorted(layers)]
    chained = all(after[1] == before[0] for before, after in pairwise(shapes))
    return chained and shapes[0][1] == inputs and shapes[-1][0] == _RESULT
