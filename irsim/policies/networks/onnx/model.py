"""ONNX models, checked before they run: known operations, known sizes, nothing outside the file."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from irsim.common.extras import require
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic
from irsim.policies.networks.errors import Limits, PolicyFileError, flaw

require("onnx", "onnx", "onnxruntime")
import onnx

__all__ = ["OPERATIONS", "OnnxModel", "Tensor", "check_model"]

_NAMES = """
    Abs Add And ArgMax AveragePool BatchNormalization Cast Ceil Clip Concat Constant ConstantOfShape Conv Cos Div Elu
    Equal Erf Exp Expand Flatten Floor GRU Gather Gelu Gemm GlobalAveragePool GlobalMaxPool Greater GreaterOrEqual
    HardSigmoid HardSwish Identity LSTM LayerNormalization LeakyRelu Less LessOrEqual Log LogSoftmax MatMul Max MaxPool
    Mean Min Mish Mul Neg Not Or PRelu Pow RNN Reciprocal ReduceL2 ReduceMax ReduceMean ReduceMin ReduceProd ReduceSum
    Relu Reshape Selu Shape Sigmoid Sign Sin Slice Softmax Softplus Softsign Split Sqrt Squeeze Sub Sum Tanh Transpose
    Unsqueeze Where
"""
OPERATIONS = frozenset(_NAMES.split())
"""Operations of the standard that depend on nothing but their inputs and whose sizes are known before they run."""
_COUNTS = ("dilations", "group", "hidden_size", "kernel_shape", "num_outputs", "strides")
"""Attributes that libraries divide by."""
_FLOATS = (1, 11)
"""The types float32 and float64."""
_PRODUCTS = ("Gemm", "MatMul", "Conv", "GRU", "LSTM", "RNN")
_FIX = "export a plain feed-forward or recurrent network of the standard operations with fixed sizes"


@dataclass(frozen=True)
class Tensor:
    """An input or output of a model.

    Attributes:
        shape: Its sizes for one robot, with the leading 1.
        type: Name of its type: ``float32``, ``float64``, ``bool``, or another.
    """

    shape: tuple[int, ...]
    type: str


@dataclass(frozen=True)
class OnnxModel:
    """A model that may run.

    Attributes:
        content: The model for one robot, serialised.
        inputs, outputs: Its tensors by name.
        metadata: Its texts by name.
        parameters: Number of numbers in it.
        work: Multiplications of a decision, roughly.
        operations: Number of operations.
    """

    content: bytes
    inputs: dict[str, Tensor]
    outputs: dict[str, Tensor]
    metadata: dict[str, str]
    parameters: int
    work: int
    operations: int


def check_model(content: bytes, source: str, limits: Limits) -> OnnxModel:
    """Parse a model, fix its first dimension to one robot and check what it would do, without running anything.

    Args:
        content: The file.
        source: Its name for messages.
        limits: How large it may be.

    Raises:
        PolicyFileError: It is not a valid model, or it may not run.
    """
    try:
        model = onnx.load_model_from_string(content)
        problems = list(_forbidden(model, limits))
        if not problems:
            for tensor in (*model.graph.input, *model.graph.output):
                _fix_rows(tensor)
            del model.graph.value_info[:]  # what a file says about sizes inside is not trusted
            onnx.checker.check_model(model)
            model = onnx.shape_inference.infer_shapes(model, check_type=True, strict_mode=True, data_prop=True)
    except Exception as error:  # the parser, the checker and the inference raise exceptions of many modules
        problems = [flaw("", f"it is not a valid ONNX model ({clean(str(error) or type(error).__name__, 200)})")]
    if problems:
        raise PolicyFileError(source, problems, _FIX)
    graph = model.graph
    constants = {tensor.name: tuple(tensor.dims) for tensor in graph.initializer}
    sizes = {**constants, **{item.name: _sizes(item) for item in (*graph.input, *graph.value_info, *graph.output)}}
    problems = [*_unknown_sizes(graph, sizes), *_integer_divisions(graph)]
    work = 0
    if not problems:
        work = sum(_work(node, sizes) for node in graph.node)
        problems = list(_over_limits(graph, constants, sizes, work, limits))
    if problems:
        raise PolicyFileError(source, problems, _FIX)
    inputs = {item.name: _tensor(item) for item in graph.input if item.name not in constants}
    outputs = {item.name: _tensor(item) for item in graph.output}
    metadata = {_text(item.key): _text(item.value) for item in model.metadata_props}
    parameters = sum(map(math.prod, constants.values()))
    return OnnxModel(model.SerializeToString(), inputs, outputs, metadata, parameters, work, len(graph.node))


def _text(value: str | bytes) -> str:
    """A text of a model; one that is not valid UTF-8 arrives as bytes."""
    return value if isinstance(value, str) else value.decode(errors="replace")


def _forbidden(model: Any, limits: Limits) -> Iterator[Diagnostic]:
    graph = model.graph
    if model.functions:
        yield flaw("functions", "a model with functions of its own is not read")
    if len(graph.node) > limits.layers * 20:
        yield flaw("graph", "too many operations", str(len(graph.node)), f"up to {limits.layers * 20}")
        return
    if len(graph.initializer) > limits.arrays:
        yield flaw("graph", "too many arrays", str(len(graph.initializer)), f"up to {limits.arrays}")
        return
    if graph.sparse_initializer:
        yield flaw("graph", "sparse arrays are not read")
    for tensor in _tensors(graph):
        if tensor.data_location or tensor.external_data:
            yield flaw(clean(tensor.name), "arrays in other files are not read")
    for node in graph.node:
        for attribute in node.attribute:
            if attribute.name in _COUNTS and any(count < 1 for count in (*attribute.ints, *_single(attribute))):
                yield flaw(clean(node.op_type), f"{attribute.name} must be at least 1")
    unknown = {(node.domain, node.op_type) for node in graph.node
               if node.domain not in ("", "ai.onnx") or node.op_type not in OPERATIONS}  # fmt: skip
    for domain, name in sorted(unknown):
        yield flaw("graph", "this operation is not run", clean(f"{domain}.{name}" if domain else name))


def _single(attribute: Any) -> tuple[int, ...]:
    """The value of an attribute that is one integer."""
    return () if attribute.ints else (attribute.i,)


def _tensors(graph: Any) -> Iterator[Any]:
    yield from graph.initializer
    for node in graph.node:
        for attribute in node.attribute:
            if attribute.HasField("t"):
                yield attribute.t
            yield from attribute.tensors


def _fix_rows(tensor: Any) -> None:
    """Set the first dimension, if it is free, to one robot."""
    sides = tensor.type.tensor_type.shape.dim
    if len(sides) > 0 and not sides[0].HasField("dim_value"):
        sides[0].dim_value = 1


def _sizes(item: Any) -> tuple[int, ...] | None:
    """Sizes of a tensor; None if one of them is unknown."""
    kind = item.type.tensor_type
    if not item.type.HasField("tensor_type") or not kind.HasField("shape"):
        return None
    sides = [side.dim_value if side.HasField("dim_value") else -1 for side in kind.shape.dim]
    return None if any(side < 0 for side in sides) else tuple(sides)


def _tensor(item: Any) -> Tensor:
    sizes = _sizes(item)
    assert sizes is not None
    return Tensor(sizes, str(onnx.helper.tensor_dtype_to_np_dtype(item.type.tensor_type.elem_type)))


def _unknown_sizes(graph: Any, sizes: dict[str, tuple[int, ...] | None]) -> Iterator[Diagnostic]:
    names = [item.name for item in (*graph.input, *graph.initializer)]
    names += [name for node in graph.node for name in node.output if name]
    for name in names:
        known = sizes.get(name)
        if known is None:
            yield flaw(clean(name), "the size of this tensor is not known before the model runs")
        elif 0 in known:
            yield flaw(clean(name), "this tensor is empty")


def _integer_divisions(graph: Any) -> Iterator[Diagnostic]:
    """Divisions of integers, which end the process if they divide by zero."""
    types = {item.name: item.type.tensor_type.elem_type for item in (*graph.value_info, *graph.output)}
    for node in graph.node:
        if node.op_type == "Div" and types.get(node.output[0]) not in _FLOATS:
            yield flaw(clean(node.output[0]), "only numbers of the types float32 and float64 are divided")


def _work(node: Any, sizes: dict[str, tuple[int, ...] | None]) -> int:
    """Multiplications of a node: products of its result and what is summed, or one per number."""
    results = sum(math.prod(sizes[name] or ()) for name in node.output if name)
    if node.op_type not in _PRODUCTS:
        inputs = sum(math.prod(sizes.get(name) or ()) for name in node.input if name)
        return max(results, inputs)
    first, weights = (sizes.get(name) or (1,) for name in node.input[:2])
    if node.op_type in ("GRU", "LSTM", "RNN"):
        recurrent = sizes.get(node.input[2]) or (1,)
        return int(first[0]) * (math.prod(weights) + math.prod(recurrent))
    if node.op_type == "Conv":
        return results * math.prod(weights[1:])
    return results * max(first)


def _over_limits(
    graph: Any,
    constants: dict[str, tuple[int, ...]],
    sizes: dict[str, tuple[int, ...] | None],
    work: int,
    limits: Limits,
) -> Iterator[Diagnostic]:
    numbers = sum(math.prod(sizes[name] or ()) for node in graph.node for name in node.output if name)
    for what, size, most in (
        ("parameters", sum(map(math.prod, constants.values())), limits.parameters),
        ("numbers that operations return for a robot", numbers, limits.numbers),
        ("multiplications for each decision", work, limits.work),
    ):
        if size > most:
            yield flaw("graph", f"too many {what}", str(size), f"up to {most}")
