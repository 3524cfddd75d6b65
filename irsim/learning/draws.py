"""The draws of the present episodes of worlds, as arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.common.text import clean, listed
from irsim.diagnostics.diagnostic import suggestion
from irsim.learning.tasks.files import task_error
from irsim.learning.tasks.scene import TaskScene
from irsim.learning.tasks.task import QUANTITIES, Task, merged
from irsim.scenario.resolve.resolved import DrawnQuantity
from irsim.simulation.simulation import Simulation

__all__ = ["Draws", "check_observed", "observed_names"]

_ARRAYS = {
    "number": "takes_part",
    "size": "size_scale",
    "speed": "speed_scale",
    "acceleration": "acceleration_scale",
    "sensor_noise": "noise_scale",
    "latency": "latency",
    "delay": "delay_scale",
    "lag": "lag_scale",
    "sensor_rate": "sensor_rate_scale",
    "sensor_latency": "sensor_latency_scale",
    "slip": "slip_scale",
    "grip": "grip_scale",
}
"""Quantity -> array of the state of the core."""


class Draws:
    """Reads what was drawn.

    Args:
        task: The task.
        scene: Its scenario.
        simulation: Its worlds.
        learners: (A,) indices of the learners in a world.

    Attributes:
        size: Number of draws that a learner observes.
        latency: Largest latency [steps].
        varies: Whether anything is drawn, at any level.
    """

    def __init__(self, task: Task, scene: TaskScene, simulation: Simulation, learners: NDArray[np.int64]) -> None:
        self._simulation, self._learners = simulation, learners
        drawn = [one for level in scene.levels for one in level.drawn]
        row = {record.id: index for index, record in enumerate(scene.scenario.objects)}
        self._objects = {(one.quantity, one.word): np.array([row[i] for i in one.objects]) for one in drawn}
        self._together = {(one.quantity, one.word): one.same for one in drawn}
        self._parameters = {name: np.array(values) for name, values in scene.parameters.items()}
        self.latency = int(max((one.high for one in drawn if one.quantity == "latency"), default=0))
        self.varies = scene.scenario.variation is not None
        self._observed = [_Column(name, drawn, self._parameters) for name in observed_names(task)]
        self.size = len(self._observed)

    def values(self) -> dict[str, NDArray[Any]]:
        """The drawn values, for all n worlds.

        - ``number.WORD``: (n,) objects that take part
        - ``size.WORD`` and the like: (n, k) values of the k objects of a word, or (n,) if they share one draw
        - ``parameters.NAME``: (n,) value of a parameter of the template
        - ``variant``: (n,) number of the variant
        """
        drawn: dict[str, NDArray[Any]] = {}
        for (quantity, word), objects in self._objects.items():
            if quantity == "number":
                drawn[f"number.{word}"] = self._count(word)
            else:
                chosen = objects[0] if self._together[quantity, word] else objects
                drawn[f"{quantity}.{word}"] = self._array(quantity)[:, chosen].copy()
        for name, values in self._parameters.items():
            drawn[f"parameters.{name}"] = values[self._simulation.state.variant]
        if self._parameters:
            drawn["variant"] = self._simulation.state.variant.copy()
        return drawn

    def latencies(self) -> NDArray[np.int64]:
        """(n * A,) latency of each learner [steps]."""
        return self._array("latency")[:, self._learners].reshape(-1).astype(np.int64)

    def observed(self) -> NDArray[np.float32]:
        """(n * A, size) draws that learners observe, from 0 to 1."""
        simulation = self._simulation
        shape = simulation.copies, len(self._learners)
        columns: list[Floats] = []
        for column in self._observed:
            if column.parameter is not None:
                values = column.parameter[simulation.state.variant][:, None]
            elif column.quantity == "number":
                values = self._count(column.word)[:, None]
            else:
                values = self._array(column.quantity)[:, self._learners]
            scaled = (values.astype(np.float64) - column.low) / ((column.high - column.low) or 1.0)
            columns.append(np.broadcast_to(np.clip(scaled, 0.0, 1.0), shape).reshape(-1))
        return np.stack(columns, axis=1).astype(np.float32)

    def _count(self, word: str) -> NDArray[np.int64]:
        """(n,) number of objects of a word that take part."""
        counts: NDArray[np.int64] = (self._array("number")[:, self._objects["number", word]] != 0).sum(axis=1)
        return counts

    def _array(self, quantity: str) -> NDArray[Any]:
        array: NDArray[Any] = getattr(self._simulation.state, _ARRAYS[quantity])
        return array.reshape(self._simulation.copies, self._simulation.objects)


class _Column:
    """A draw that learners observe."""

    def __init__(self, name: str, drawn: list[DrawnQuantity], parameters: dict[str, NDArray[Any]]) -> None:
        self.quantity, _, self.word = name.partition(".")
        self.parameter = parameters.get(self.word) if self.quantity == "parameters" else None
        if self.parameter is not None:
            self.low, self.high = float(self.parameter.min()), float(self.parameter.max())
            return
        neutral = [] if self.quantity == "number" else [0.0 if self.quantity == "latency" else 1.0]
        same = [one for one in drawn if one.quantity == self.quantity and self.word in ("", one.word)]
        self.low = min([one.low for one in same] + neutral)
        self.high = max([one.high for one in same] + neutral)


def observed_names(task: Task) -> list[str]:
    """Names of the draws that learners observe, at all levels."""
    return list(
        dict.fromkeys(name for level in task.levels for name in merged(task.randomize, level.randomize).observed)
    )


def check_observed(task: Task, scene: TaskScene) -> None:
    """Refuse names of draws that do not exist, or that are not numbers.

    Raises:
        TaskError: There is one.
    """
    known = [quantity for quantity in QUANTITIES if quantity != "number"]
    known = [name for name in known if any(one.quantity == name for level in scene.levels for one in level.drawn)]
    known += [f"number.{one.word}" for level in scene.levels for one in level.drawn if one.quantity == "number"]
    known += [f"parameters.{name}" for name, values in scene.parameters.items() if not isinstance(values[0], str)]
    known = list(dict.fromkeys(known))
    for name in observed_names(task):
        if name not in known:
            fix = suggestion(name, known, f"choose from {listed(known, 10)}" if known else "leave it out")
            raise task_error(("randomize", "observed"), f"{clean(name)!r} is not drawn as a number", fix)
