"""Sensors that report a few numbers, as scripts use them: odometry, imu, sonar and others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

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
        self.attach(simulation, index)

    def attach(self, simulation: Simulation, index: int) -> None:
        """Attach the sensor to the one with this index of the same object in a simulation."""
        own = [(first, number) for owner, first, number in simulation.gauges if owner == self.parent.index]
        first, number = own[index]
        first += self.parent.world * simulation.world.readings_per_world
        self._numbers: Floats = simulation.state.readings[first : first + number]

    @property
    def data(self) -> Floats:
        """Copy of the numbers of the last step, (len(names),)."""
        return self._numbers.copy()

    def read(self) -> dict[str, float]:
        """Return the numbers of the last step by name."""
        return dict(zip(self.names, self._numbers.tolist(), strict=True))

    def step(self, state: Any = None) -> None:
        """Do nothing: there is one reading in each step.

        Args:
            state: Ignored.
        """

    def __repr__(self) -> str:
        told = ", ".join(f"{name} {value:.4g}" for name, value in self.read().items())
        return f"<sensor {self.sensor_type!r} of {self.parent.name!r}: {told}>"
