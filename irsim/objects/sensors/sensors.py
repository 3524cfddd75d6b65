"""The sensors of an object as scripts use them: lidars of the core, and sensors that user code has registered."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.components.sensors._gauges import GaugeOptions
from irsim.components.sensors.contact2d import Contact2d
from irsim.objects.sensors.contact import Contact2D
from irsim.objects.sensors.gauge import Gauge
from irsim.objects.sensors.lidar import FMCWLidar2D, Lidar2D
from irsim.options.registry import SENSORS, Feature
from irsim.simulation.random_streams import generator

if TYPE_CHECKING:
    from irsim.objects.base import SimObject
    from irsim.simulation.simulation import Simulation

__all__ = ["PythonSensor", "attach_python_sensors", "attach_sensors", "sensors_of"]

_LIDARS = {"lidar2d": Lidar2D, "fmcw_lidar2d": FMCWLidar2D}


class PythonSensor:
    """A sensor computed by a registered function or class.

    A function is called ``function(parent, options, rng)`` and what it returns becomes ``data``. A class is made once
    for each object, ``cls(parent, options)``. Its ``step(state)`` is called, with ``rng`` set before, and what that
    returns becomes ``data`` unless it is None; its ``reset()``, if it has one, is called when an episode begins. Other
    attributes come from the instance. Both kinds are called after the step and after all native sensors.

    Args:
        parent: The object that carries it.
        options: Validated options.
        feature: Registry entry of the sensor.
        index: Index among the sensors of the object.

    Attributes:
        sensor_type: Name of the sensor in YAML.
        data: Last measurement; None before the first one.
        instance: The object of a registered class, or None.
    """

    def __init__(self, parent: SimObject, options: Any, feature: Feature, index: int) -> None:
        self.parent, self.obj_id, self.options, self.sensor_type = parent, parent.id, options, feature.name
        self.data: Any = None
        self._index = index
        self._rng: tuple[tuple[int, ...], np.random.Generator] | None = None
        self._episode: tuple[int, ...] | None = None
        self._function: Any = feature.function
        self.instance: Any = None
        if inspect.isclass(self._function):
            made: Any = self._function
            self.instance = made(parent, options)

    @property
    def rng(self) -> np.random.Generator:
        """Generator of this measurement; its draws are the same in any batch and when the measurement is repeated."""
        simulation, world = self.parent._simulation, self.parent.world
        key = (*simulation.key(world), int(simulation.count[world]))
        if self._rng is None or self._rng[0] != key:
            seed, scene, noise, count = key
            made = generator(seed, scene, noise, "sensor", self.obj_id, index=self._index, first=count << 20)
            self._rng = key, made
        return self._rng[1]

    def step(self, state: Any = None) -> None:
        """Measure and update ``data``.

        Args:
            state: State of the carrier that is passed to ``step`` of a class; by default the present one.
        """
        self._rng = None  # measuring again repeats the draws
        if self.instance is None:
            self.data = self._function(self.parent, self.options, self.rng)
            return
        self.instance.rng = self.rng
        episode = self.parent._simulation.key(self.parent.world)
        if episode != self._episode:
            self._episode = episode
            getattr(self.instance, "reset", _nothing)()
        data = self.instance.step(self.parent.state if state is None else state)
        if data is not None:
            self.data = data

    def memory(self) -> Any:
        """The last measurement, and what the sensor remembers."""
        return self.data, self._rng, self._episode, self.instance

    def recall(self, memory: Any) -> None:
        """Continue from what :meth:`memory` returned."""
        self.data, self._rng, self._episode, self.instance = memory

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "instance" or self.instance is None:
            raise AttributeError(f"sensor {self.__dict__.get('sensor_type')!r} has no attribute {name!r}")
        return getattr(self.instance, name)

    def __repr__(self) -> str:
        return f"<sensor {self.sensor_type!r} of {self.parent.name!r}>"


def _nothing() -> None:
    """Stand in for the ``reset`` of a sensor without one."""


def sensors_of(simulation: Simulation, view: SimObject) -> list[Any]:
    """Return the sensors of an object in the order of its entry, without unimplemented ones."""
    native, gauges = _native(simulation, view), count()
    sensors: list[Any] = []
    for index, options in enumerate(view.record.sensors):
        feature = SENSORS.get(str(getattr(options, "name", "")))
        if feature is not None and feature.options is Contact2d:
            sensors.append(view.contact)
        elif feature is not None and issubclass(feature.options, GaugeOptions):
            sensors.append(Gauge(simulation, view, options, next(gauges)))
        elif feature is not None and feature.kernel is not None:
            sensors.append(_LIDARS.get(feature.name, Lidar2D)(simulation, view, options, next(native)))
        elif feature is not None and feature.function is not None:
            sensors.append(PythonSensor(view, options, feature, index))
    return sensors


def attach_sensors(simulation: Simulation, view: SimObject) -> None:
    """Attach the sensors of an object to its row in another simulation."""
    native, gauges = _native(simulation, view), count()
    for sensor in view.sensors:
        if not isinstance(sensor, (Contact2D, PythonSensor)):
            sensor.attach(simulation, next(gauges if isinstance(sensor, Gauge) else native))


def _native(simulation: Simulation, view: SimObject) -> Iterator[int]:
    """Return an iterator over the indices that the native sensors of an object have in its world."""
    return count(simulation.first_scan(view.index))


def _measure(simulation: Simulation, mask: NDArray[np.bool_] | None) -> None:
    """Let the registered sensors measure, in every world or in the worlds of a mask."""
    for world in range(simulation.copies) if mask is None else np.flatnonzero(mask):
        for view in simulation.views(int(world)):
            for sensor in view.sensors:
                if isinstance(sensor, PythonSensor):
                    sensor.step()


def attach_python_sensors(simulation: Simulation) -> None:
    """Let the registered sensors that the scenario names take part in every step, and measure now."""
    names = {str(getattr(options, "name", "")) for record in simulation.scenario.objects for options in record.sensors}
    for feature in filter(None, map(SENSORS.get, names)):
        if feature.kernel is None and feature.function is not None and feature.options is not Contact2d:
            if _measure not in simulation.measurements:
                simulation.measurements.append(_measure)
            simulation.measure()
            return
