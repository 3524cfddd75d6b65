"""ONNX models for tests, made with the onnx library."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

DOCUMENT: dict[str, Any] = {
    "format": "irsim-policy",
    "version": 1,
    "layout": {"version": 1, "parts": [{"name": "goal", "features": ["distance", "cos", "sin"]}]},
    "output": {"input": "action", "squash": "tanh", "low": [0, -3], "high": [1, 3]},
    "drives": ["diff"],
}
FLOAT = 1
"""The type float32 of ONNX."""


def tensor(name: str, sides: list[Any], kind: int = FLOAT) -> Any:
    from onnx import helper

    return helper.make_tensor_value_info(name, kind, sides)


def model(
    nodes: list[Any], inputs: list[Any], outputs: list[Any], arrays: dict[str, Any] | None = None, **options: Any
) -> Any:
    """A model of these nodes."""
    from onnx import helper, numpy_helper

    constants = [numpy_helper.from_array(array, name) for name, array in (arrays or {}).items()]
    graph = helper.make_graph(nodes, "net", inputs, outputs, constants)
    opsets = [helper.make_opsetid("", 17), *options.pop("opsets", [])]
    return helper.make_model(graph, opset_imports=opsets, ir_version=9, **options)


def weights(seed: int = 0, inputs: int = 3) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    sizes = {"w0": (inputs, 64), "b0": (64,), "w1": (64, 2), "b1": (2,)}
    return {name: rng.normal(size=size).astype(np.float32) for name, size in sizes.items()}


def perceptron(input_name: str = "goal", inputs: int = 3, rows: Any = "batch") -> Any:
    """Two dense layers with a rectifier between them."""
    from onnx import helper

    nodes = [
        helper.make_node("Gemm", [input_name, "w0", "b0"], ["h"]),
        helper.make_node("Relu", ["h"], ["r"]),
        helper.make_node("Gemm", ["r", "w1", "b1"], ["action"]),
    ]
    ends = [tensor(input_name, [rows, inputs])], [tensor("action", [rows, 2])]
    return model(nodes, *ends, weights(inputs=inputs))


def write(path: Path, made: Any, document: Any = DOCUMENT, *, inside: bool = True) -> Path:
    """Write a model with its document, inside or beside it."""
    text = document if isinstance(document, str) else json.dumps(document)
    if inside and document is not None:
        made.metadata_props.add(key="irsim", value=text)
    elif document is not None:
        path.with_suffix(".json").write_text(text)
    path.write_bytes(made.SerializeToString())
    return path
