"""An object as a rigid body: mass, friction, inertia, and what contacts do to it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.objects.base import SimObject, column
from irsim.objects.sensors.contact import Contact2D

__all__ = ["ObjectDynamics"]

Floats = NDArray[np.float64]


class ObjectDynamics(SimObject):
    """Physics of one row of a simulation, for ``collision_mode: contact``."""

    contact: Contact2D

    @property
    def mass(self) -> float:
        """Mass [kg]; infinite for what nothing can push."""
        return self.record.mass

    @property
    def friction(self) -> float:
        """Coefficient of friction with the ground."""
        return self.record.friction

    @property
    def restitution(self) -> float:
        """Bounciness, 0 to 1."""
        return self.record.restitution

    @property
    def inertia(self) -> float:
        """Moment of inertia about the centroid [kg m^2]."""
        if self.record.inertia is not None:
            return self.record.inertia
        return self.mass * self._simulation.state.body(self.row)[2]

    @property
    def inv_mass(self) -> float:
        """1 / mass; 0 for what cannot be pushed."""
        return self._simulation.state.body(self.row)[0]

    @property
    def inv_inertia(self) -> float:
        """1 / inertia; 0 for what cannot be pushed."""
        return self._simulation.state.body(self.row)[1]

    @property
    def gyration(self) -> float:
        """Radius of gyration [m]: root of inertia over mass; 0 for infinite masses."""
        return math.sqrt(self.inertia / self.mass) if math.isfinite(self.mass) else 0.0

    @property
    def pushable(self) -> bool:
        """Whether contacts can move it: not static, finite mass."""
        return not self.static and math.isfinite(self.mass)

    @property
    def passive(self) -> bool:
        """Whether it has no drive."""
        return self.record.kinematics is None

    @property
    def friction_force(self) -> float:
        """Greatest force that friction with the ground gives: traction of drives, resistance of passive bodies [N]."""
        gravity = self._simulation.scenario.world.gravity
        return self.friction * self.mass * gravity if self.friction > 0.0 else 0.0

    @property
    def drive_tau(self) -> float:
        """Lag of the drive [s]."""
        return self.record.drive_tau

    @property
    def drive_velocity_xy(self) -> Floats:
        """(2, 1) world-frame velocity that the drive aims at, before contacts interfere [m/s]."""
        simulation, row = self._simulation, self.row
        handler = None if simulation.drives is None else simulation.drives.handler(row)
        if simulation.drives is None or handler is None:
            return column(simulation.state.drive_velocity_world(row))
        control = simulation.drive_of(row, self.record.vel_dim)[:, None].copy()
        state = simulation.row_state(row, self.record.state_dim)[:, None]
        return column(np.asarray(handler.velocity_to_xy(state, control), dtype=np.float64).reshape(-1)[:2])

    def apply_contact_displacement(self, dxy: Any, dtheta: float = 0.0) -> None:
        """Move the object as a contact would, within one period; its velocity changes accordingly.

        Args:
            dxy: 2 numbers, displacement in the world frame [m].
            dtheta: Turn about the centroid [rad].
        """
        dx, dy = np.asarray(dxy, dtype=np.float64).reshape(-1)[:2].tolist()
        with self._simulation.feeling():
            core.shift(self._simulation.world, self._simulation.state, self.row, (dx, dy), float(dtheta))

    def apply_contact_velocity(self, dv: Any) -> None:
        """Change the velocity by ``dv``: 2 numbers, world frame [m/s]."""
        dx, dy = np.asarray(dv, dtype=np.float64).reshape(-1)[:2].tolist()
        with self._simulation.feeling():
            core.push(self._simulation.world, self._simulation.state, self.row, (dx, dy))
