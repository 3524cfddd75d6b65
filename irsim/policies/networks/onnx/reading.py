"""Reads ``.onnx`` files as policies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from irsim.common.extras import require
from irsim.common.text import clean
from irsim.policies.networks.archive import read_bytes
from irsim.policies.networks.errors import PolicyFileError, Problem
from irsim.policies.networks.files import parse_json
from irsim.policies.networks.layout import layout_shapes
from irsim.policies.networks.limits import Limits
from irsim.policies.networks.network import output_problems, read_document
from irsim.policies.networks.onnx.document import OnnxDocument
from irsim.policies.networks.onnx.model import OnnxModel, Tensor, check_model
from irsim.policies.networks.onnx.policy import OnnxPolicy
from irsim.policies.networks.values import Shape

__all__ = ["METADATA", "open_onnx"]

METADATA = "irsim"
"""Key of the JSON document among the texts of a model."""
_FIX = "name the inputs of the model like the parts of the layout, with a first dimension for the robots"
_FLOATS = ("float32", "float64")


def open_onnx(path: Path, content: bytes, facts: Mapping[str, Any], limits: Limits) -> OnnxPolicy:
    """The policy in an ONNX model and its document.

    The document is the text ``irsim`` among the metadata of the model, else the file of the same name with the suffix
    ``.json``.

    Args:
        path: The file.
        content: Its bytes.
        facts: What is known about it.
        limits: How large it may be.

    Raises:
        PolicyFileError: Model or document are not valid, or do not fit together.
        ExtraError: onnx or onnxruntime are not installed.
    """
    require("onnx", "onnx", "onnxruntime")
    source = clean(str(path))
    model = check_model(content, source, limits)
    text = model.metadata.get(METADATA)
    if text is None:
        beside = path.with_suffix(".json")
        if not beside.is_file():
            missing = Problem("", f"the model says neither in its metadata '{METADATA}' nor in a file what it observes")
            raise PolicyFileError(source, [missing], f"write the JSON document to {clean(beside.name)}")
        source, written = clean(str(beside)), read_bytes(beside, limits.document_bytes)
    else:
        written = text.encode()
    document: OnnxDocument = read_document(OnnxDocument, parse_json(written, source, limits), source)
    problems = [*_input_problems(document, model), *_output_problems(document, model)]
    if problems:
        raise PolicyFileError(source, problems, _FIX)
    try:
        policy = OnnxPolicy(path.stem, document, model, {"format": "onnx", **facts})
        policy.try_once()
    except Exception as error:  # onnxruntime has exceptions of its own, and RuntimeError
        broken = Problem("", f"onnxruntime does not run it ({clean(str(error), 200)})")
        raise PolicyFileError(source, [broken], _FIX) from None
    return policy


def _input_problems(document: OnnxDocument, model: OnnxModel) -> Iterator[Problem]:
    wanted: dict[str, tuple[tuple[int, ...], tuple[str, ...]]] = {}
    shapes = layout_shapes(document.layout)
    if document.joined is not None:
        size = sum(shape.features * (shape.members or 1) for shape in shapes.values())
        wanted[document.joined] = ((1, size), _FLOATS)
    else:
        for label, shape in shapes.items():
            members = () if shape.members is None else (shape.members,)
            sides = (1, *members, shape.features)
            wanted[label] = (sides, _FLOATS)
            if shape.members is not None and f"{label}_mask" in model.inputs:
                wanted[f"{label}_mask"] = ((1, shape.members), (*_FLOATS, "bool"))
    for name, result in document.memory.items():
        given, after = model.inputs.get(name), model.outputs.get(result)
        if after is None:
            yield Problem(f"memory.{clean(name)}", "the model has no such output", clean(result))
        elif given is not None and given != after:
            yield Problem(f"memory.{clean(name)}", "input and output differ", _text(after), _text(given))
        elif given is not None:
            wanted[name] = (given.shape, _FLOATS)
    for name, (sides, types) in wanted.items():
        tensor = model.inputs.get(name)
        if tensor is None:
            yield Problem(clean(name), "the model has no such input", "", ", ".join(map(clean, model.inputs)))
        elif tensor.shape != sides or tensor.type not in types:
            allowed = f"{' or '.join(types)} {' x '.join(map(str, sides))}"
            yield Problem(clean(name), "this input of the model has another shape or type", _text(tensor), allowed)
    for name in model.inputs.keys() - wanted.keys() - document.memory.keys():
        yield Problem(clean(name), "the layout has no part for this input of the model")


def _output_problems(document: OnnxDocument, model: OnnxModel) -> Iterator[Problem]:
    tensor = model.outputs.get(document.output.input)
    if tensor is None:
        found = ", ".join(map(clean, model.outputs))
        yield Problem("output.input", "the model has no such output", document.output.input, found)
    elif len(tensor.shape) != 2 or tensor.shape[0] != 1 or tensor.type not in _FLOATS:
        yield Problem("output.input", "the result is a row of numbers for each robot", _text(tensor), "1 x numbers")
    else:
        yield from output_problems(document, {document.output.input: Shape(tensor.shape[1])})


def _text(tensor: Tensor) -> str:
    return f"{tensor.type} {' x '.join(map(str, tensor.shape))}"
