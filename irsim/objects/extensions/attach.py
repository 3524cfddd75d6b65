"""Attaches all user code of a scenario to a simulation: drives, behaviors and sensors written in Python."""

from __future__ import annotations

from irsim.objects.extensions.behaviors import attach_python_behaviors
from irsim.objects.extensions.drives import attach_python_drives
from irsim.objects.sensors.sensors import attach_python_sensors
from irsim.simulation.simulation import Simulation

__all__ = ["attach_python"]


def attach_python(simulation: Simulation, *, anew: bool = False) -> None:
    """Attach drives, behaviors and sensors of user code; call it again after the objects have changed.

    Args:
        simulation: The simulation.
        anew: Construct drives, and behaviors that are classes, again.
    """
    attach_python_drives(simulation, anew=anew)
    attach_python_behaviors(simulation, anew=anew)
    attach_python_sensors(simulation)
