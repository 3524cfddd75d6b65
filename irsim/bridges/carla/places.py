"""Where objects are in the frame of CARLA, and the commands with which actors move as irsim wants."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from irsim.bridges.carla.actors import Role, place
from irsim.bridges.frames import axes_of, planar_pose, pose_matrix, to_frame, to_irsim
from irsim.common.angles import wrap
from irsim.common.arrays import Floats

__all__ = [
    "Places",
    "pose_of_state",
    "shifted",
    "shifted_twist",
    "steering",
    "still_commands",
    "vehicle_commands",
    "walker_commands",
]


@dataclass(frozen=True)
class Places:
    """Where the scenario is.

    Attributes:
        x, y: Origin of the scenario [m], frame of CARLA.
        yaw: Direction of its x axis [deg], clockwise.
    """

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    @property
    def transform(self) -> Floats:
        """(4, 4) the motion that is applied after the change to CARLA's axes."""
        return pose_matrix(np.array([self.x, self.y, math.radians(self.yaw)]))

    @property
    def matrix(self) -> Floats:
        """(4, 4) ``T_carla_from_irsim``: maps points x, y, z, 1 of irsim to CARLA."""
        axes = np.eye(4)
        axes[:3, :3] = axes_of("carla")
        result: Floats = self.transform @ axes
        return result

    def to_carla(self, pose: Floats) -> Floats:
        """(..., 3) x, y [m], yaw [deg] of CARLA for poses (..., 3) x, y [m], yaw [rad] of irsim."""
        result = planar_pose(to_frame(pose_matrix(pose), "carla", self.transform))
        result[..., 2] = np.degrees(result[..., 2])
        return result

    def to_irsim(self, place: Floats) -> Floats:
        """The inverse of :meth:`to_carla`."""
        place = np.array(place, dtype=np.float64)
        place[..., 2] = np.radians(place[..., 2])
        return planar_pose(to_irsim(pose_matrix(place), "carla", self.transform))

    def velocity_to_carla(self, velocity: Floats) -> Floats:
        """(..., 3) velocity x, y [m/s] and yaw rate [deg/s] of CARLA for (..., 3) vx, vy [m/s], yaw rate [rad/s]."""
        result = np.array(velocity, dtype=np.float64)
        result[..., :2] = result[..., :2] @ self.matrix[:2, :2].T
        result[..., 2] = -np.degrees(result[..., 2])
        return result

    def velocity_to_irsim(self, velocity: Floats) -> Floats:
        """The inverse of :meth:`velocity_to_carla`."""
        result = np.array(velocity, dtype=np.float64)
        result[..., :2] = result[..., :2] @ self.matrix[:2, :2]
        result[..., 2] = -np.radians(result[..., 2])
        return result


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
