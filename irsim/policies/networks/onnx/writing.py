"""Writes networks of the layers of irsim as ONNX models, for programs that have no irsim."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from irsim.common.extras import require
from irsim.common.files import check_suffix, replace_bytes
from irsim.common.text import clean
from irsim.policies.networks.errors import PolicyFileError, flaw
from irsim.policies.networks.layout import layout_shapes
from irsim.policies.networks.network import FIX, Network, check_network
from irsim.policies.networks.onnx.policy import METADATA, OnnxDocument
from irsim.policies.networks.values import Array

require("onnx", "onnx")
from onnx import TensorProto, helper, numpy_helper

__all__ = ["onnx_bytes", "save_onnx"]

_OPSET, _IR_VERSION = 17, 9
"""Versions of the operations and of the format, which onnxruntime 1.20 and newer read."""
_ACTIVATIONS = {"relu": "Relu", "tanh": "Tanh", "sigmoid": "Sigmoid", "elu": "Elu"}


def save_onnx(path: str | Path, network: Network) -> None:
    """Write a network to an ``.onnx`` file in one step.

    The model has one input for each part of the observation, ``<label>_mask`` for each set, and one output, whose
    numbers mean what the JSON document among its metadata says under ``output``. Its first dimension is the number of
    robots.

    Args:
        path: The file, which is replaced if it exists; its folder must exist.
        network: The network.

    Raises:
        PolicyFileError: The network has a layer or an activation that is not written.
        ExtraError: onnx is not installed.
        TargetError: The file has another suffix.
    """
    path = Path(path)
    check_suffix(path, [".onnx"])
    replace_bytes(path, onnx_bytes(network, clean(str(path))), mode=None)


def onnx_bytes(network: Network, source: str = "network") -> bytes:
    """The ONNX model of a network; equal networks give equal bytes.

    Args:
        network: The network.
        source: Name for messages.

    Raises:
        PolicyFileError: The network has a layer or an activation that is not written.
        ExtraError: onnx is not installed.
    """
    plan = check_network(network, source)
    _check_layers(network, source)
    document = network.document
    graph = _Graph(np.dtype(document.precision))
    kind = graph.kind
    inputs = []
    for label, shape in layout_shapes(document.layout).items():
        members = [] if shape.members is None else [shape.members]
        inputs.append(helper.make_tensor_value_info(label, kind, ["robots", *members, shape.features]))
        if shape.members is not None:
            inputs.append(helper.make_tensor_value_info(f"{label}_mask", kind, ["robots", *members]))
            graph.masks[label] = graph.node("Cast", [f"{label}_mask"], to=TensorProto.BOOL)
            graph.members[label] = shape.members
    arrays = network.by_layer()
    for layer in document.network:
        _WRITERS[layer.name](graph, layer, arrays.get(layer.label, {}))
    result = document.output.input
    output = helper.make_tensor_value_info(result, kind, ["robots", plan.shapes[result].features])
    made = helper.make_graph(graph.nodes, "policy", inputs, [output], graph.constants)
    opset = [helper.make_opsetid("", _OPSET)]
    model = helper.make_model(made, opset_imports=opset, ir_version=_IR_VERSION, producer_name="irsim")
    head = document.model_dump(mode="json", include={"layout", "output", "drives", "decision_dt", "card"})
    text = OnnxDocument.model_validate(head).model_dump(mode="json")
    model.metadata_props.add(key=METADATA, value=json.dumps(text, sort_keys=True, ensure_ascii=False, allow_nan=False))
    content: bytes = model.SerializeToString(deterministic=True)
    return content


class _Graph:
    """Collects operations and arrays.

    Attributes:
        type: Type of its numbers.
        kind: The same type as ONNX numbers it.
        masks: Label of a set -> name of the tensor (robots, members) of bool that says which members are present.
        members: Label of a set -> number of its members.
    """

    def __init__(self, type: np.dtype[Any]) -> None:
        self.type, self.kind = type, helper.np_dtype_to_tensor_dtype(type)
        self.nodes: list[Any] = []
        self.constants: list[Any] = []
        self.masks: dict[str, str] = {}
        self.members: dict[str, int] = {}

    def node(self, operation: str, inputs: list[str], output: str | None = None, **attributes: Any) -> str:
        """Add an operation, and return the name of its result."""
        name = output or f"_{len(self.nodes)}"
        self.nodes.append(helper.make_node(operation, inputs, [name], **attributes))
        return name

    def constant(self, array: Array) -> str:
        """Add an array, and return its name."""
        name = f"_c{len(self.constants)}"
        self.constants.append(numpy_helper.from_array(np.ascontiguousarray(array), name))
        return name

    def number(self, value: float) -> str:
        """Add a number."""
        return self.constant(np.array(value, dtype=self.type))

    def axis(self, value: int) -> str:
        """Add the number of a dimension."""
        return self.constant(np.array([value], dtype=np.int64))


def _check_layers(network: Network, source: str) -> None:
    problems = []
    for k, layer in enumerate(network.document.network):
        where = ("network", k)
        if layer.name not in _WRITERS:
            problems.append(flaw(where, "this layer is not written as ONNX", layer.name, ", ".join(_WRITERS)))
        elif (activation := getattr(layer, "activation", "none")) not in ("none", *_ACTIVATIONS):
            allowed = ", ".join(("none", *_ACTIVATIONS))
            problems.append(flaw(where, "this activation is not written as ONNX", activation, allowed))
    if problems:
        raise PolicyFileError(source, problems, FIX)


def _concat(graph: _Graph, layer: Any, arrays: dict[str, Array]) -> None:
    sets = [label for label in layer.inputs if label in graph.masks]
    if not sets:
        graph.node("Concat", list(layer.inputs), layer.label, axis=1)
        return
    members = graph.members[sets[0]]
    mask = graph.masks[sets[0]]
    for other in sets[1:]:
        mask = graph.node("And", [mask, graph.masks[other]])
    spread = []
    for label in layer.inputs:
        if label not in graph.masks:
            row = graph.node("Unsqueeze", [label, graph.axis(1)])
            spread.append(graph.node("Concat", [row] * members, axis=1))
        else:
            spread.append(label)
    graph.node("Concat", spread, layer.label, axis=2)
    graph.masks[layer.label], graph.members[layer.label] = mask, members


def _dense(graph: _Graph, layer: Any, arrays: dict[str, Array]) -> None:
    (before,) = layer.inputs
    active = _ACTIVATIONS.get(layer.activation)
    last = layer.label if active is None else None
    if layer.bias:
        product = graph.node("MatMul", [before, graph.constant(arrays["w"])])
        result = graph.node("Add", [product, graph.constant(arrays["b"])], last)
    else:
        result = graph.node("MatMul", [before, graph.constant(arrays["w"])], last)
    if active is not None:
        graph.node(active, [result], layer.label)
    if before in graph.masks:
        graph.masks[layer.label], graph.members[layer.label] = graph.masks[before], graph.members[before]


def _pool(graph: _Graph, layer: Any, arrays: dict[str, Array]) -> None:
    (before,) = layer.inputs
    each = graph.node("Unsqueeze", [graph.masks[before], graph.axis(2)])
    zero = graph.number(0.0)
    present = graph.node("Cast", [graph.masks[before]], to=graph.kind)
    if layer.method == "max":
        shown = graph.node("Where", [each, before, graph.number(-np.inf)])
        largest = graph.node("ReduceMax", [shown], axes=[1], keepdims=0)
        some = graph.node("Cast", [graph.node("ReduceMax", [present], axes=[1], keepdims=1)], to=TensorProto.BOOL)
        graph.node("Where", [some, largest, zero], layer.label)
        return
    shown = graph.node("Where", [each, before, zero])
    mean = layer.method == "mean"
    total = graph.node("ReduceSum", [shown, graph.axis(1)], None if mean else layer.label, keepdims=0)
    if mean:
        count = graph.node("ReduceSum", [present, graph.axis(1)], keepdims=1)
        graph.node("Div", [total, graph.node("Max", [count, graph.number(1.0)])], layer.label)


_WRITERS: dict[str, Callable[[_Graph, Any, dict[str, Array]], None]] = {
    "concat": _concat,
    "dense": _dense,
    "pool": _pool,
}
