"""Messages out of an environment, and odometry into it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim import msg
from irsim.env_access import EnvAccess
from irsim.scans import Lidar2D

if TYPE_CHECKING:
    from irsim.views import ObjectView

__all__ = ["EnvMessages", "resolve_message_targets"]

_STANDING = 1e-6
"""A slower car [m/s] does not tell its steering."""


class EnvMessages(EnvAccess):
    """``get_msg`` and ``receive_msg`` of an environment."""

    def get_msg(self, use_inf: bool = False) -> msg.WorldState:
        """Everything as it is now.

        Args:
            use_inf: Ranges of beams that hit nothing are +inf, of hits nearer than ``range_min`` -inf.
        """
        status: str = self.status  # type: ignore[attr-defined]
        header = self._header("world")
        states = [self._state_of(view, use_inf) for view in self._objects]
        return msg.WorldState(header, self.scenario.name, status, self._world.step_time, states)

    def _header(self, frame: str) -> msg.Header:
        return msg.Header(self._world.count, self._world.time, frame)

    def _state_of(self, view: ObjectView, use_inf: bool) -> msg.ObjectState:
        lidars = [sensor for sensor in view.sensors if isinstance(sensor, Lidar2D)]
        scans = [self._scan_of(lidar, k, use_inf) for k, lidar in enumerate(lidars)]
        goal, contact = view.goal, getattr(view, "contact", None)
        force = [0.0, 0.0] if contact is None else np.asarray(contact.force).reshape(-1).tolist()
        return msg.ObjectState(
            header=self._header("world"),
            id=view.id,
            name=view.name,
            role=view.role,
            kinematics=view.kinematics,
            shape=view.shape,
            odom=self._odometry_of(view),
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

    def _odometry_of(self, view: ObjectView) -> msg.Odometry:
        x, y, theta = view.state[:3, 0].tolist()
        return msg.Odometry(
            header=self._header("world"),
            child_frame_id=f"{view.name}/base_link",
            pose=msg.PoseWithCovariance(msg.Pose(msg.Point(x, y, float(view.z)), msg.Quaternion.from_yaw(theta))),
            twist=msg.TwistWithCovariance(_twist(view)),
        )

    def _scan_of(self, lidar: Lidar2D, number: int, use_inf: bool) -> msg.LaserScan:
        scan = lidar.get_scan()
        ranges = np.array(scan["ranges"], dtype=np.float32)
        if use_inf:
            hit = lidar.hits >= 0
            ranges[~scan["valid"]] = np.inf
            ranges[hit & ~scan["valid"] & (scan["ranges"] <= lidar.range_min)] = -np.inf
        frame = f"{lidar.parent.name}/laser" + (f"_{number}" if number else "")
        keys = ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max")
        return msg.LaserScan(
            header=self._header(frame),
            **{key: float(scan[key]) for key in keys},
            ranges=ranges,
            intensities=np.zeros(0, dtype=np.float32),
        )

    def receive_msg(
        self, msg: Any, *, object_name: str | None = None, object_id: int | None = None, refresh: bool = True
    ) -> int:
        """Put objects where a message says they are, moving as it says.

        Args:
            msg: A ``WorldState``, an ``ObjectState``, or odometry: anything with ``pose.pose`` and ``twist.twist``, a
                native ROS message too.
            object_name: Whose state it is; default: the name and id in the message, for odometry the first robot.
            object_id: The same by id.
            refresh: Then evaluate collisions and sensors anew.

        Returns:
            How many objects were put.

        Raises:
            ValueError: No such object, or numbers that are not finite; nothing has been changed then.
            TypeError: Not such a message.
        """
        pairs = resolve_message_targets(self._objects, msg, object_name, object_id, default_target=lambda: self.robot)
        changes = [(view, *_read(view, odometry)) for view, odometry in pairs]
        for view, state, velocity in changes:
            view.set_state(state)
            if velocity is not None:
                view.set_velocity(velocity)
        if refresh:
            self._simulation.refresh()
        return len(changes)


def resolve_message_targets(
    objects: Sequence[Any],
    msg: Any,
    object_name: str | None = None,
    object_id: int | None = None,
    *,
    default_target: Any,
) -> list[tuple[Any, Any]]:
    """Pairs of object and odometry that a message means.

    Args:
        objects: The objects there are.
        msg: ``WorldState``, ``ObjectState`` or odometry.
        object_name: Over the name in the message.
        object_id: Over the id in the message.
        default_target: Called for the object of odometry that names none.

    Returns:
        Every object that is meant, once.

    Raises:
        ValueError: No object of that name and id.
    """
    if hasattr(msg, "objects"):
        return [(_named(objects, state.name, state.id), state.odom) for state in msg.objects]
    odometry = getattr(msg, "odom", msg)
    if object_name is not None or object_id is not None:
        return [(_named(objects, object_name, object_id), odometry)]
    if odometry is not msg:
        return [(_named(objects, msg.name, msg.id), odometry)]
    if not (hasattr(odometry, "pose") and hasattr(odometry, "twist")):
        raise TypeError(f"a message has pose.pose and twist.twist, like odometry of ROS; this is {type(msg).__name__}")
    return [(default_target(), odometry)]


def _named(objects: Sequence[Any], name: str | None, object_id: int | None) -> Any:
    by_name = [view for view in objects if name is not None and view.name == name]
    by_id = [view for view in objects if object_id is not None and view.id == object_id]
    found = by_name or by_id
    if not found:
        raise ValueError(f"no object has the name {name!r} or the id {object_id!r} of this message")
    return found[0]


def _twist(view: ObjectView) -> msg.Twist:
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


def _read(view: ObjectView, odometry: Any) -> tuple[list[float], list[float] | None]:
    """State and control that odometry means for an object; no control for what has no drive."""
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
    state = view.state[:, 0].tolist()
    state[:3] = [x, y, msg.Quaternion(qx, qy, qz, qw).to_yaw()]
    if view.kinematics is None:
        return state, None
    control = view.velocity[:, 0].tolist()
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
