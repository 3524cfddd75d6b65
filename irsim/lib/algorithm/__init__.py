"""Names that IR-SIM scripts import from ``irsim.lib.algorithm``; plain re-exports."""

from irsim.lib.algorithm.kinematics import (
    ackermann_kinematics,
    differential_kinematics,
    omni_angular_kinematics,
    omni_kinematics,
)

__all__ = ["ackermann_kinematics", "differential_kinematics", "omni_angular_kinematics", "omni_kinematics"]
