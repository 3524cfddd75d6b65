"""Messages out of objects and sensors, and odometry back into numbers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from irsim.msg import messages as msg

__all__ = ["numbers_of", "odometry_of", "scan_of", "state_of", "world_of"]

_STANDING = 1e-6
"""A slower car [m/s] does not tell its steering."""
_SCAN_KEYS = ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max")


def world_of(env: Any, frame: str, use_inf: bool) -> msg.WorldState:
    """Everything in an environment."""
    header = msg.Header(env._world.count, env._world.time, frame)
    states = [state_of(view, header, use_inf) for view in env.objects]
    return msg.WorldState(header, env._world.name, env.status, env.step_time, states)


def state_of(view: Any, header: msg.Header, use_inf: bool) -> msg.ObjectState:
    """Everything about one object."""
    lidars = [sensor for sensor in view.sensors if hasattr(sensor, "get_scan") and hasattr(sensor, "hits")]
    scans = []
    for number, lidar in enumerate(lidars):
        frame = f"{view.name}/laser" + (f"_{number}" if number else "")
        scans.append(scan_of(lidar, msg.Header(header.seq, header.stamp, frame), use_inf))
    goal, contact = view.goal, getattr(view, "contact", None)
    force = [0.0, 0.0] if contact is None else np.asarray(contact.force).reshape(-1).tolist()
    return msg.ObjectState(
        header=_copy(header),
        id=view.id,
        name=view.name,
        role=view.role,
        kinematics=view.kinematics,
        shape=view.shape,
        odom=odometry_of(view, _copy(header)),
        scan=scans[0] if scans else None,
        goal=None if goal is None else goal.copy(),
        static=view.static,
        arrive=view.arrive,
        collision=view.collision,
        collision_ids=[other.id for other in view.collision_obj],
        scans=scans,
        contact_force=msg.Vector3(*force),
        contact_time=0.0 if contact is None else float(contact.contact_time),
        air_time=0.0 if contact is None else float(contact.air_time),
        contacts=[] if contact is None else [_contact(report) for report in contact.reports],
    )


def odometry_of(view: Any, header: msg.Header) -> msg.Odometry:
    """Where an object is and how it moves."""
    x, y, theta = np.asarray(view.state)[:3, 0].tolist()
    return msg.Odometry(
        header=header,
        child_frame_id=f"{view.name}/base_link",
        pose=msg.PoseWithCovariance(msg.Pose(msg.Point(x, y, float(view.z)), msg.Quaternion.from_yaw(theta))),
        twist=msg.TwistWithCovariance(_twist(view)),
    )


def scan_of(lidar: Any, header: msg.Header, use_inf: bool) -> msg.LaserScan:
    """What a lidar measures; see ``env.get_msg`` for ``use_inf``."""
    scan = lidar.get_scan()
    ranges = np.array(scan["ranges"], dtype=np.float32)
    if use_inf:
        hit = lidar.hits >= 0
        ranges[~scan["valid"]] = np.inf
        ranges[hit & ~scan["valid"] & (scan["ranges"] <= lidar.range_min)] = -np.inf
    return msg.LaserScan(
        header=header,
        **{key: float(scan[key]) for key in _SCAN_KEYS},
        ranges=ranges,
        intensities=np.zeros(0, dtype=np.float32),
    )


def numbers_of(view: Any, odometry: Any) -> tuple[list[float], list[float] | None]:
    """State and control that odometry means for an object; no control for what has no drive.

    Raises:
        TypeError: Not odometry.
        ValueError: Numbers that are not finite.
    """
    try:
        pose, twist = odometry.pose.pose, odometry.twist.twist
        turn = pose.orientation
        numbers = [float(v) for v in (pose.position.x, pose.position.y, turn.x, turn.y, turn.z, turn.w)]
        numbers += [float(v) for v in (twist.linear.x, twist.linear.y, twist.angular.z)]
    except (AttributeError, TypeError) as error:
        raise TypeError(f"odometry has pose.pose and twist.twist, with numbers in them: {error}") from None
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f"odometry for {view.name!r} is not finite")
    x, y, qx, qy, qz, qw, forward, lateral, rate = numbers
    state: list[float] = view.state[:, 0].tolist()
    state[:3] = [x, y, msg.Quaternion(qx, qy, qz, qw).to_yaw()]
    if view.kinematics is None:
        return state, None
    control: list[float] = view.velocity[:, 0].tolist()
    control[0] = forward
    if view.kinematics == "acker":
        if abs(forward) > _STANDING:
            state[3] = math.atan(rate * (view.wheelbase or 1.0) / forward)
        control[1] = state[3]
    elif view.kinematics in ("omni", "omni_angular"):
        control[1:] = [lateral, rate][: len(control) - 1]
    elif len(control) > 1:
        control[1] = rate
    return state, control


def _copy(header: msg.Header) -> msg.Header:
    return msg.Header(header.seq, header.stamp, header.frame_id)


def _twist(view: Any) -> msg.Twist:
    """Velocity in the body frame that the present control gives."""
    control = [*view.velocity[:, 0].tolist(), 0.0, 0.0]
    forward, lateral, rate = 0.0, 0.0, 0.0
    if view.kinematics in ("omni", "omni_angular"):
        forward, lateral, rate = control[0], control[1], control[2] if view.vel_dim > 2 else 0.0
    elif view.kinematics == "acker":
        forward = control[0]
        rate = forward * math.tan(float(view.state[3, 0])) / (view.wheelbase or 1.0)
    elif view.kinematics is not None:
        forward, rate = control[0], control[1]
    return msg.Twist(msg.Vector3(forward, lateral, 0.0), msg.Vector3(0.0, 0.0, rate))


def _contact(report: Any) -> msg.ContactState:
    point, normal = np.asarray(report.point).reshape(-1), np.asarray(report.normal).reshape(-1)
    return msg.ContactState(
        other_id=report.other.id,
        other=report.other.name,
        point=msg.Point(*point.tolist()),
        normal=msg.Vector3(*normal.tolist()),
        depth=float(report.depth),
        force=float(report.force),
    )
