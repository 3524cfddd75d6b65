"""The part of an object that is a rigid body: mass, friction, inertia, and reactions to contacts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.objects.base import SimObject, column
from irsim.objects.sensors.contact import Contact2D

__all__ = ["ObjectDynamics"]


class ObjectDynamics(SimObject):
    """Physics of one object, for ``collision_mode: contact``; part of :class:`irsim.objects.view.ObjectView`."""

    contact: Contact2D

    @property
    def mass(self) -> float:
        """Mass [kg]; infinite for objects that contacts cannot push."""
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
        """1 / mass [1/kg]; 0 for objects that contacts cannot push."""
        return self._simulation.state.body(self.row)[0]

    @property
    def inv_inertia(self) -> float:
        """1 / inertia [1/(kg m^2)]; 0 for objects that contacts cannot push."""
        return self._simulation.state.body(self.row)[1]

    @property
    def gyration(self) -> float:
        """Radius of gyration [m], the square root of inertia over mass; 0 for an infinite mass."""
        return math.sqrt(self.inertia / self.mass) if math.isfinite(self.mass) else 0.0

    @property
    def pushable(self) -> bool:
        """Whether contacts can move the object.

        That requires a finite mass, and that it is neither static nor an obstacle that replays a recording.
        """
        replays = self.record.recorded and self.record.role == "obstacle"
        return not self.static and math.isfinite(self.mass) and not replays

    @property
    def passive(self) -> bool:
        """Whether the object has no drive."""
        return self.record.kinematics is None

    @property
    def friction_force(self) -> float:
        """Largest friction force of the ground [N]: traction of a drive, or resistance of a passive body."""
        gravity = self._simulation.scenario.world.gravity
        return self.friction * self.mass * gravity if self.friction > 0.0 else 0.0

    @property
    def drive_tau(self) -> float:
        """Lag of the drive [s]."""
        return self.record.drive_tau

    @property
    def drive_velocity_xy(self) -> Floats:
        """World-frame velocity of the drive before contacts change it, (2, 1) [m/s]."""
        simulation, row = self._simulation, self.row
        handler = None if simulation.drives is None else simulation.drives.handler(row)
        if simulation.drives is None or handler is None:
            return column(simulation.state.drive_velocity_world(row))
        control = simulation.drive_of(row, self.record.vel_dim)[:, None].copy()
        state = simulation.row_state(row, self.record.state_dim)[:, None]
        return column(np.asarray(handler.velocity_to_xy(state, control), dtype=np.float64).reshape(-1)[:2])

    def apply_contact_displacement(self, dxy: Any, dtheta: float = 0.0) -> None:
        """Move the object as a contact does within one period, and change its velocity accordingly.

        Args:
            dxy: Displacement in the world frame, 2 numbers [m].
            dtheta: Rotation about the centroid [rad].
        """
        dx, dy = np.asarray(dxy, dtype=np.float64).reshape(-1)[:2].tolist()
        with self._simulation.feeling():
            core.shift(self._simulation.world, self._simulation.state, self.row, (dx, dy), float(dtheta))

    def apply_contact_velocity(self, dv: Any) -> None:
        """Add ``dv``, 2 numbers in the world frame [m/s], to the velocity."""
        dx, dy = np.asarray(dv, dtype=np.float64).reshape(-1)[:2].tolist()
        with self._simulation.feeling():
            core.push(self._simulation.world, self._simulation.state, self.row, (dx, dy))
