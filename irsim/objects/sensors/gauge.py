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
    """A sensor of one object that reports a few numbers in each step.

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
        own = [(first, number) for owner, first, number in simulation.gauges if owner == self.parent.index]
        first, number = own[index]
        first += self.parent.world * simulation.world.readings_per_world
        self._numbers: Floats = simulation.state.readings[first : first + number]

    @property
    def data(self) -> Floats:
        """Copy of the numbers of the last step, (len(names),) or rows of them one after the other."""
        return self._numbers.copy()

    def read(self) -> dict[str, Any]:
        """Return the numbers of the last step by name; a sensor that reports rows of them has a list of rows.

        A detector has ``{"tracks": [{"id": 0.0, "x": 2.1, ...}, ...]}``, without rows that are empty.
        """
        if not self._table:
            return dict(zip(self.names, self._numbers.tolist(), strict=True))
        rows = self._numbers.reshape(-1, len(self.names))
        kept = rows[np.isfinite(rows[:, 0])]
        return {self._table: [dict(zip(self.names, row, strict=True)) for row in kept.tolist()]}

    def step(self, state: Any = None) -> None:
        """Do nothing: there is one reading in each step.

        Args:
            state: Ignored.
        """

    def __repr__(self) -> str:
        told = ", ".join(
            f"{name} {value:.4g}" if isinstance(value, float) else f"{len(value)} {name}"
            for name, value in self.read().items()
        )
        return f"<sensor {self.sensor_type!r} of {self.parent.name!r}: {told}>"
