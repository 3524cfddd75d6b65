"""An object as the modules know it that make it up: its row of a simulation, its record, and its state."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from irsim.common.arrays import Floats

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = ["SimObject", "column"]


def column(values: Any) -> Floats:
    """Return a read-only copy of numbers as a column (n, 1)."""
    copied = np.array(values, dtype=np.float64).reshape(-1, 1)
    copied.setflags(False)  # type: ignore[call-arg]  # NumPy takes it; named, it takes longer than the copy
    return copied


class SimObject(Protocol):
    """An object of a simulation; :class:`irsim.objects.view.ObjectView` is one, and documents these names."""

    record: ObjectRecord
    id: int
    name: str
    role: Any
    group: int
    static: bool
    unobstructed: bool
    state_dim: int
    vel_dim: int
    sensors: list[Any]
    lidar: Any
    contact: Any
    index: int
    world: int
    row: int
    _simulation: Simulation
    _made_beside: Any

    @property
    def kinematics(self) -> str | None:
        """Name of the drive; None without one."""
        ...

    @property
    def state(self) -> Floats:
        """State (3 or more, 1)."""
        ...

    @property
    def velocity(self) -> Floats:
        """Executed control in the command frame of the drive, (vel_dim, 1)."""
        ...

    @property
    def velocity_xy(self) -> Floats:
        """Velocity in the world frame, (2, 1) [m/s]."""
        ...

    @property
    def init_state(self) -> Floats:
        """The state to which ``reset`` returns, (state_dim, 1)."""
        ...

    @property
    def goals(self) -> list[Floats]:
        """The present goal and the goals after it, (2 or 3, 1) each."""
        ...

    def set_state(self, state: Any = None, init: bool = False) -> None:
        """Set the state of the object."""

    def amend(self, record: ObjectRecord) -> None:
        """Replace the record by another one with the same id."""
