"""Networks from the plain weights of a multilayer perceptron."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from irsim.policies.networks.document import PolicyDocument
from irsim.policies.networks.errors import PolicyFileError, flaw
from irsim.policies.networks.layers._options import Activation
from irsim.policies.networks.layout import Layout, layout_shapes
from irsim.policies.networks.network import Network, check_network, read_document
from irsim.policies.networks.values import Array

__all__ = ["mlp"]

_FIX = (
    "give (W, b) pairs, or arrays named W0, b0, W1, b1, … (inputs, outputs), or 0.weight, 0.bias, … as PyTorch has them"
)


def mlp(
    weights: Mapping[str, Any] | Sequence[tuple[Any, Any]],
    parts: Sequence[Mapping[str, Any]],
    *,
    activation: Activation = "relu",
    output: Mapping[str, Any] | None = None,
    drives: Sequence[str] | None = None,
    decision_dt: float | None = None,
    card: Mapping[str, Any] | None = None,
    precision: str = "float32",
) -> Network:
    """A network of plain weights.

    ::

        weights = numpy.load("weights.npz")  # W0, b0, W1, b1
        network = mlp(weights, [{"name": "goal"}, {"name": "own"}], drives=["diff"], output={"limits": True})
        save_network("mine.npz", network)

    Args:
        weights: Pairs of weights (inputs, outputs) and biases (outputs), in order; or a mapping with ``W0``, ``b0``,
            ``W1``, ``b1``, …; or one with ``….weight`` (outputs, inputs) and ``….bias`` as PyTorch has them.
        parts: Observations of the network; its inputs are these numbers in this order.
        activation: Function after each layer but the last.
        output: Keys of the output but for ``input``; see :class:`irsim.policies.networks.document.OutputOptions`.
        drives: Drives whose controls it returns; None for velocities.
        decision_dt: Time between two decisions [s]; None decides in each step.
        card: Where the weights come from.
        precision: ``float32`` or ``float64``.

    Raises:
        PolicyFileError: The weights do not fit one another, the parts or the output.
    """
    source = "mlp"
    pairs = _pairs(weights, source)
    layout = read_document(Layout, {"parts": [dict(part) for part in parts]}, source)
    layers: list[dict[str, Any]] = []
    inputs = []
    for label, shape in layout_shapes(layout).items():
        if shape.members is not None:
            layers.append({"name": "flatten", "label": f"{label}_flat", "inputs": [label]})
        inputs.append(label if shape.members is None else f"{label}_flat")
    layers.append({"name": "concat", "label": "observed", "inputs": inputs})
    arrays: dict[str, Array] = {}
    for k, (weight, bias) in enumerate(pairs):
        last = k == len(pairs) - 1
        label, before = f"dense_{k}", f"dense_{k - 1}" if k else "observed"
        function = "none" if last else activation
        units = bias.shape[0]
        layers.append({"name": "dense", "label": label, "inputs": [before], "units": units, "activation": function})
        arrays |= {f"{label}.w": weight.astype(precision), f"{label}.b": bias.astype(precision)}
    data = {
        "layout": layout,
        "precision": precision,
        "network": layers,
        "output": {"input": f"dense_{len(pairs) - 1}", **(output or {})},
        "drives": None if drives is None else list(drives),
        "decision_dt": decision_dt,
        "card": dict(card or {}),
    }
    network = Network(read_document(PolicyDocument, data, source), arrays)
    check_network(network, source)
    return network


def _pairs(weights: Mapping[str, Any] | Sequence[tuple[Any, Any]], source: str) -> list[tuple[Array, Array]]:
    """Weights (inputs, outputs) and biases (outputs) in the order of the layers."""
    if isinstance(weights, Mapping) or hasattr(weights, "files"):
        named = {str(name): weights[name] for name in weights}  # type: ignore[call-overload,index]
        result = _numbered(named) or _of_torch(named)
    else:
        result = [(np.asarray(w), np.asarray(b)) for w, b in weights]
    if not result:
        raise PolicyFileError(source, [flaw("weights", "no layers are found")], _FIX)
    for k, (w, b) in enumerate(result):
        if w.ndim != 2 or b.shape != w.shape[1:]:
            shapes = f"{w.shape} and {b.shape}"
            raise PolicyFileError(source, [flaw(("weights", k), "the shapes do not fit", shapes, "(I, O), (O,)")], _FIX)
    return result


def _numbered(named: Mapping[str, Any]) -> list[tuple[Array, Array]]:
    result: list[tuple[Array, Array]] = []
    while f"W{len(result)}" in named and f"b{len(result)}" in named:
        result.append((np.asarray(named[f"W{len(result)}"]), np.asarray(named[f"b{len(result)}"])))
    return result if len(named) == 2 * len(result) else []


def _of_torch(named: Mapping[str, Any]) -> list[tuple[Array, Array]]:
    stems = [name.removesuffix(".weight") for name in named if name.endswith(".weight")]
    if {*named} != {f"{stem}{end}" for stem in stems for end in (".weight", ".bias")}:
        return []
    stems.sort(key=lambda stem: [int(word) if word.isdigit() else word for word in re.split(r"(\d+)", stem)])
    return [(np.asarray(named[f"{stem}.weight"]).T, np.asarray(named[f"{stem}.bias"])) for stem in stems]
