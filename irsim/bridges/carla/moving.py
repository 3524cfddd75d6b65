"""Commands to actors in a step: walkers walk to their places in the scenario, vehicles get speed and steering."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from irsim.bridges.carla.actors import Role, place
from irsim.bridges.carla.places import Places
from irsim.common.angles import wrap
from irsim.common.arrays import Floats

__all__ = [
    "pose_of_state",
    "shifted",
    "shifted_twist",
    "steering",
    "still_commands",
    "vehicle_commands",
    "walker_commands",
]

_HERE = 1e-6
"""Distance [m] below which a walker stands."""
_STANDS = 1e-3
"""Speed [m/s] below which a car keeps its steering angle."""


def shifted(pose: Floats, ahead: float) -> Floats:
    """(3,) the pose of a point that is ahead of the origin of a body [m], at x, y [m], yaw [rad]."""
    x, y, yaw = pose
    return np.array([x + ahead * math.cos(yaw), y + ahead * math.sin(yaw), yaw])


def shifted_twist(twist: Floats, yaw: float, ahead: float) -> Floats:
    """(3,) vx, vy [m/s], yaw rate [rad/s] of such a point."""
    vx, vy, rate = twist
    return np.array([vx - rate * ahead * math.sin(yaw), vy + rate * ahead * math.cos(yaw), rate])


def walker_commands(
    carla: Any, number: int, here: tuple[float, ...], before: Floats, after: Floats, period: float, correction: float
) -> tuple[list[Any], bool]:
    """Commands to a walker for one step.

    Args:
        carla: The module.
        number: Id of the walker.
        here: x, y, z [m] where it is.
        before: (3,) x, y [m], yaw [deg] where it should be at the start of the step, frame of CARLA.
        after: (3,) where it should be at its end.
        period: Duration of the step [s].
        correction: Distance from which on it is put where it should be [m].

    Returns:
        The commands, and whether it is put.
    """
    commands, x, y = [], here[0], here[1]
    put = math.hypot(before[0] - x, before[1] - y) > correction
    if put:
        x, y = float(before[0]), float(before[1])
        commands.append(carla.command.ApplyTransform(number, place(carla, before, here[2])))
    away = float(after[0]) - x, float(after[1]) - y
    distance = math.hypot(*away)
    course, speed = math.radians(float(after[2])), 0.0
    if distance > _HERE:
        course, speed = math.atan2(away[1], away[0]), distance / period
    control = carla.WalkerControl(carla.Vector3D(math.cos(course), math.sin(course), 0.0), speed, False)
    commands.append(carla.command.ApplyWalkerControl(number, control))
    return commands, put


def steering(pose: Floats, twist: Floats, period: float, wheelbase: float, last: float) -> tuple[float, float]:
    """Speed [m/s] and steering angle [rad], positive to the left, of a car that moves so.

    Args:
        pose: (3,) x, y [m], yaw [rad] at the end of the step.
        twist: (3,) mean vx, vy [m/s], yaw rate [rad/s] during the step, world frame.
        period: Duration of the step [s].
        wheelbase: Of the car [m].
        last: Its steering angle before [rad], kept while it stands.
    """
    heading = pose[2] - twist[2] * period
    speed = float(twist[0] * math.cos(heading) + twist[1] * math.sin(heading))
    if abs(speed) < _STANDS:
        return 0.0, last
    return speed, math.atan(wheelbase * float(twist[2]) / speed)


def vehicle_commands(
    carla: Any, number: int, role: Role, how: str, pose: Floats, twist: Floats, speed: float, steer: float,
    places: Places, height: float, rise: float,
) -> list[Any]:  # fmt: skip
    """Commands to a vehicle for one step.

    Args:
        carla: The module.
        number: Id of the vehicle.
        role: Its role.
        how: ``ackermann``, ``velocity`` or ``transform``.
        pose: (3,) x, y [m], yaw [rad] at the end of the step, frame of irsim.
        twist: (3,) vx, vy [m/s], yaw rate [rad/s] during the step, frame of irsim.
        speed: Forward speed [m/s].
        steer: Steering angle, positive to the left [rad].
        places: Where the scenario is.
        height: z of its transform [m].
        rise: Its present velocity upwards [m/s], which stays.
    """
    command = carla.command
    if how == "transform":
        at = places.to_carla(shifted(pose, role.ahead))
        return [command.ApplyTransform(number, place(carla, at, height))]
    if how == "ackermann":  # positive steering turns to the right in CARLA, as its yaw does
        control = carla.VehicleAckermannControl(steer=-steer, steer_speed=0.0, speed=speed, acceleration=0.0, jerk=0.0)
        return [command.ApplyVehicleAckermannControl(number, control)]
    vx, vy, rate = (float(v) for v in places.velocity_to_carla(shifted_twist(twist, float(pose[2]), role.ahead)))
    return [
        command.ApplyTargetVelocity(number, carla.Vector3D(vx, vy, rise)),
        command.ApplyTargetAngularVelocity(number, carla.Vector3D(0.0, 0.0, rate)),
    ]


def still_commands(carla: Any, number: int) -> list[Any]:
    """Commands with which a vehicle stands still."""
    command = carla.command
    return [
        command.ApplyVehicleAckermannControl(number, carla.VehicleAckermannControl()),
        command.ApplyTargetVelocity(number, carla.Vector3D()),
    ]


def pose_of_state(
    state: Any, places: Places, ahead: float
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Where an object is, and how it moves, from the state of its actor.

    Args:
        state: The state in a snapshot.
        places: Where the scenario is.
        ahead: How far the middle of the body is ahead of its origin [m].

    Returns:
        x, y [m], yaw [rad], and vx, vy [m/s], yaw rate [rad/s], frame of irsim.
    """
    transform, velocity, spin = state.get_transform(), state.get_velocity(), state.get_angular_velocity()
    at = np.array([transform.location.x, transform.location.y, transform.rotation.yaw])
    pose = shifted(places.to_irsim(at), -ahead)
    moving = places.velocity_to_irsim(np.array([velocity.x, velocity.y, spin.z]))
    vx, vy, rate = (float(value) for value in shifted_twist(moving, float(pose[2]), -ahead))
    return (float(pose[0]), float(pose[1]), float(wrap(float(pose[2])))), (vx, vy, rate)
