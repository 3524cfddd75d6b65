"""ONNX models as policies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common.text import clean
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.network_policy import NetworkPolicy
from irsim.policies.networks.onnx.document import OnnxDocument
from irsim.policies.networks.onnx.model import OnnxModel
from irsim.policies.networks.slots import Slots
from irsim.policies.networks.values import Array, Value

if TYPE_CHECKING:
    from irsim.policies.observations import Observations

__all__ = ["OnnxPolicy"]


class OnnxPolicy(NetworkPolicy):
    """An ONNX model, run by onnxruntime for one robot after the other on one thread.

    The kernels of onnxruntime add in an order that depends on the number of rows, so a batch would not give the bits of
    its rows. On other processors, or with another version of onnxruntime, the last bits may differ.

    Args:
        name: Its name in tables.
        document: What it observes, and what its result means.
        model: The model.
        facts: What :meth:`describe` adds.
    """

    def __init__(self, name: str, document: OnnxDocument, model: OnnxModel, facts: Mapping[str, Any]) -> None:
        import onnxruntime

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
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.execution_mode = onnxruntime.ExecutionMode.ORT_SEQUENTIAL
    options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_ENABLE_BASIC
    options.enable_cpu_mem_arena = options.enable_mem_pattern = False
    options.use_deterministic_compute = True
    options.log_severity_level = 4
    return onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])
