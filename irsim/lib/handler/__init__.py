"""Names that IR-SIM scripts import from ``irsim.lib.handler``; plain re-exports."""

from irsim.lib.handler.geometry_handler import GeometryFactory
from irsim.lib.handler.kinematics_handler import KinematicsFactory, KinematicsHandler, register_kinematics

__all__ = ["GeometryFactory", "KinematicsFactory", "KinematicsHandler", "register_kinematics"]
