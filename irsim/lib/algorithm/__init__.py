"""Names that IR-SIM scripts import from ``irsim.lib.algorithm``; plain re-exports."""

from irsim.lib.algorithm.generation import generate_polygon, random_generate_polygon
from irsim.lib.algorithm.kinematics import (
    ackermann_kinematics,
    differential_kinematics,
    omni_angular_kinematics,
    omni_kinematics,
)
from irsim.lib.algorithm.ray_casting_2d import cast_rays
from irsim.lib.algorithm.rvo import reciprocal_vel_obs
from irsim.lib.algorithm.social_force_model import SocialForceModelBatch, social_force_model

__all__ = [
    "SocialForceModelBatch",
    "ackermann_kinematics",
    "cast_rays",
    "differential_kinematics",
    "generate_polygon",
    "omni_angular_kinematics",
    "omni_kinematics",
    "random_generate_polygon",
    "reciprocal_vel_obs",
    "social_force_model",
]
