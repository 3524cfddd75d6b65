"""ONNX models as policies: the document that says what a model observes, and whether both fit together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import ConfigDict, Field

from irsim.common.extras import require
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic
from irsim.policies.networks.document import PolicyHead
from irsim.policies.networks.errors import Limits, PolicyFileError, PolicyInputError, flaw
from irsim.policies.networks.files import file_bytes, parse_json
from irsim.policies.networks.layout import layout_shapes
from irsim.policies.networks.network import output_problems, read_document
from irsim.policies.networks.network_policy import NetworkPolicy, Slots
from irsim.policies.networks.onnx.model import OnnxModel, Tensor, check_model
from irsim.policies.networks.values import Array, Shape, Value

if TYPE_CHECKING:
    from irsim.policies.observations import Observations

require("onnx", "onnx", "onnxruntime")
import onnxruntime

__all__ = ["METADATA", "OnnxDocument", "OnnxPolicy", "open_onnx"]

METADATA = "irsim"
"""Key of the JSON document among the texts of a model."""
_FIX = "name the inputs of the model like the parts of the layout, with a first dimension for the robots"
_FLOATS = ("float32", "float64")
Name = Annotated[str, Field(max_length=200)]


class OnnxDocument(PolicyHead):
    """Observations of an ONNX model, and the meaning of its result.

    Inputs of the model are named like the parts. A set has another input `<label>_mask` (1, members), if the model has
    an input of that name. `output.input` is the name of an output of the model, which may contain only letters, digits
    and underscores.
    """

    model_config = ConfigDict(title="Policy")

    format: Literal["irsim-policy"] = "irsim-policy"
    """Says that this is a policy of irsim."""
    version: Literal[1] = 1
    """Version of the format."""
    joined: Name | None = None
    """Name of the one input that gets all parts one after the other, sets with zeros for absent members."""
    memory: Annotated[dict[Name, Name], Field(max_length=16)] = {}
    """Name of an input → name of the output that it gets at the robot's next decision; zeros at the first one."""


class OnnxPolicy(NetworkPolicy):
    """An ONNX model, run by onnxruntime for one robot after the other on one thread.

    The kernels of onnxruntime add in an order that depends on the number of rows, so a batch would not give the bits of
    its rows. On other processors, or with another version of onnxruntime, the last bits may differ.

    Args:
        name: Its name in tables.
        document: Its observations, and the meaning of its result.
        model: The model.
        facts: Additions to :meth:`describe`.
    """

    def __init__(self, name: str, document: OnnxDocument, model: OnnxModel, facts: Mapping[str, Any]) -> None:
        memory = {before: model.inputs[before] for before in document.memory}
        remembered = sum(int(np.prod(tensor.shape)) for tensor in memory.values())
        size = {"parameters": model.parameters, "work": model.work, "memory": remembered}
        runtime = {"operations": model.operations, "runtime": f"onnxruntime {onnxruntime.__version__}"}
        super().__init__(name, document, {**facts, **size, **runtime})
        self._document, self._model = document, model
        self._session = _session(model.content)
        self._slots = None
        if memory:
            sizes = {name: int(np.prod(tensor.shape)) for name, tensor in memory.items()}
            self._slots = Slots(sizes, np.dtype(np.float64))

    def try_once(self) -> None:
        """Run the model once, with zeros.

        Raises:
            PolicyInputError: It fails.
        """
        feed = {name: np.zeros(tensor.shape, tensor.type) for name, tensor in self._model.inputs.items()}
        self._run([self._document.output.input, *self._document.memory.values()], feed)

    def compute(self, observed: Mapping[str, Value], observations: Observations) -> Array:
        """(B, F) result of the model, row by row."""
        inputs = self._inputs(observed)
        rows, memory = (None, {}) if self._slots is None else self._slots.recall(observations)
        remembered = list(self._document.memory.items())
        wanted = [self._document.output.input, *(after for _, after in remembered)]
        results = []
        for b in range(len(observations)):
            feed = {name: array[b : b + 1] for name, array in inputs.items()}
            for before, _ in remembered:
                tensor = self._model.inputs[before]
                feed[before] = memory[before][b].reshape(tensor.shape).astype(tensor.type)
            result, *after = self._run(wanted, feed)
            results.append(result[0])
            for (before, _), state in zip(remembered, after, strict=True):
                memory[before][b] = state.reshape(-1)
        if self._slots is not None and rows is not None:
            self._slots.store(rows, memory)
        return np.array(results).reshape(len(observations), self._model.outputs[wanted[0]].shape[1])

    def _run(self, wanted: list[str], feed: dict[str, Array]) -> list[Array]:
        try:
            results: list[Array] = self._session.run(wanted, feed)
        except Exception as error:  # onnxruntime has exceptions of its own, and RuntimeError
            message = f"the model {self.name} failed: {clean(str(error), 200)}"
            raise PolicyInputError(message, "export a model that accepts all numbers within the bounds") from None
        for name, result in zip(wanted, results, strict=True):
            if result.shape != self._model.outputs[name].shape:
                message = f"the model {self.name} returned {name} of shape {result.shape}"
                raise PolicyInputError(message, "export a model with fixed sizes")
        return results

    def _inputs(self, observed: Mapping[str, Value]) -> dict[str, Array]:
        """Arrays of all robots by the names of the model's inputs."""
        joined = self._document.joined
        if joined is not None:
            flat = np.concatenate([value.flat() for value in observed.values()], axis=1)
            return {joined: flat.astype(self._model.inputs[joined].type)}
        arrays: dict[str, Array] = {}
        for label, value in observed.items():
            arrays[label] = value.present().astype(self._model.inputs[label].type)
            mask = f"{label}_mask"
            if value.mask is not None and mask in self._model.inputs:
                arrays[mask] = value.mask.astype(self._model.inputs[mask].type)
        return {name: np.ascontiguousarray(array) for name, array in arrays.items()}


def _session(content: bytes) -> Any:
    """A session on one thread of the processor, without memory that grows."""
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.execution_mode = onnxruntime.ExecutionMode.ORT_SEQUENTIAL
    options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_ENABLE_BASIC
    options.enable_cpu_mem_arena = options.enable_mem_pattern = False
    options.use_deterministic_compute = True
    options.log_severity_level = 4
    return onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])


def open_onnx(path: Path, content: bytes, facts: Mapping[str, Any], limits: Limits) -> OnnxPolicy:
    """The policy in an ONNX model and its document.

    The document is the text ``irsim`` among the metadata of the model, else the file of the same name with the suffix
    ``.json``.

    Args:
        path: The file.
        content: Its bytes.
        facts: Facts known about it.
        limits: How large it may be.

    Raises:
        PolicyFileError: Model or document are not valid, or do not fit together.
    """
    source = clean(str(path))
    model = check_model(content, source, limits)
    text = model.metadata.get(METADATA)
    if text is None:
        beside = path.with_suffix(".json")
        if not beside.is_file():
            missing = flaw("", f"the model says neither in its metadata '{METADATA}' nor in a file what it observes")
            raise PolicyFileError(source, [missing], f"write the JSON document to {clean(beside.name)}")
        source, written = clean(str(beside)), file_bytes(beside, limits.document_bytes)
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
        broken = flaw("", f"onnxruntime does not run it ({clean(str(error), 200)})")
        raise PolicyFileError(source, [broken], _FIX) from None
    return policy


def _input_problems(document: OnnxDocument, model: OnnxModel) -> Iterator[Diagnostic]:
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
            yield flaw(f"memory.{clean(name)}", "the model has no such output", clean(result))
        elif given is not None and given != after:
            yield flaw(f"memory.{clean(name)}", "input and output differ", _text(after), _text(given))
        elif given is not None:
            wanted[name] = (given.shape, _FLOATS)
    for name, (sides, types) in wanted.items():
        tensor = model.inputs.get(name)
        if tensor is None:
            yield flaw(clean(name), "the model has no such input", "", ", ".join(map(clean, model.inputs)))
        elif tensor.shape != sides or tensor.type not in types:
            allowed = f"{' or '.join(types)} {' x '.join(map(str, sides))}"
            yield flaw(clean(name), "this input of the model has another shape or type", _text(tensor), allowed)
    for name in model.inputs.keys() - wanted.keys() - document.memory.keys():
        yield flaw(clean(name), "the layout has no part for this input of the model")


def _output_problems(document: OnnxDocument, model: OnnxModel) -> Iterator[Diagnostic]:
    tensor = model.outputs.get(document.output.input)
    if tensor is None:
        result = ", ".join(map(clean, model.outputs))
        yield flaw(("output", "input"), "the model has no such output", document.output.input, result)
    elif len(tensor.shape) != 2 or tensor.shape[0] != 1 or tensor.type not in _FLOATS:
        yield flaw(("output", "input"), "the result is a row of numbers for each robot", _text(tensor), "1 x numbers")
    else:
        yield from output_problems(document, {document.output.input: Shape(tensor.shape[1])})


def _text(tensor: Tensor) -> str:
    return f"{tensor.type} {' x '.join(map(str, tensor.shape))}"
