"""Sensors that report a few numbers, as scripts use them: odometry, imu, sonar and others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common.arrays import Floats

if TYPE_CHECKING:
    from irsim.objects.base import SimObject
    from irsim.simulation.simulation import Simulation

__all__ = ["Gauge"]


class Gauge:
    """A sensor of one object that reports a few numbers.

    Args:
        simulation: The simulation.
        parent: The object that carries it.
        options: Validated options of the sensor.
        index: Number of the sensor among the sensors of its object that report numbers.

    Attributes:
        sensor_type: Name of the sensor in YAML.
        names: Names of its numbers, in their order.
        units: Their units.
    """

    def __init__(self, simulation: Simulation, parent: SimObject, options: Any, index: int) -> None:
        self.parent, self.obj_id, self.options = parent, parent.id, options
        self.sensor_type = str(options.name)
        numbers: tuple[tuple[str, str], ...] = options.numbers()
        self.names, self.units = tuple(name for name, _ in numbers), tuple(unit for _, unit in numbers)
        self._table: str = options.table
        self.attach(simulation, index)

    def attach(self, simulation: Simulation, index: int) -> None:
        """Attach the sensor to the one with this index of the same object in a simulation."""
        own = [
            (k, first, number)
            for k, (owner, first, number) in enumerate(simulation.gauges)
            if owner == self.parent.index
        ]
        place, first, number = own[index]
        first += self.parent.world * simulation.world.readings_per_world
        self._numbers: Floats = simulation.state.readings[first : first + number]
        self._stamps: Floats = simulation.state.stamp[self.parent.world]
        self._place = len(simulation.scans) + place

    @property
    def data(self) -> Floats:
        """Copy of the last numbers that have arrived, (len(names),) or rows of them one after the other.

        They are NaN before the first ones.
        """
        return self._numbers.copy()

    @property
    def stamp(self) -> float:
        """Time at which these numbers were measured [s]; NaN before the first ones."""
        return float(self._stamps[self._place])

    def read(self) -> dict[str, Any]:
        """Return the last numbers that have arrived by name; with a `rate` or a `latency` also ``stamp`` [s].

        A sensor that reports rows of numbers has a list of rows: ``{"tracks": [{"id": 0.0, "x": 2.1, ...}, ...]}`` of a
        detector, without rows that are empty.
        """
        stamp = {"stamp": self.stamp} if self.options.is_timed else {}
        if not self._table:
            return {**dict(zip(self.names, self._numbers.tolist(), strict=True)), **stamp}
        rows = self._numbers.reshape(-1, len(self.names))
        kept = rows[np.isfinite(rows[:, 0])]
        return {self._table: [dict(zip(self.names, row, strict=True)) for row in kept.tolist()], **stamp}

    def step(self, state: Any = None) -> None:
        """Do nothing: readings come with the steps of the simulation.

        Args:
            state: Ignored.
        """

    def __repr__(self) -> str:
        told = ", ".join(
            f"{name} {value:.4g}" if isinstance(value, float) else f"{len(value)} {name}"
            for name, value in self.read().items()
        )
        return f"<sensor {self.sensor_type!r} of {self.parent.name!r}: {told}>"
