"""Methods of an environment that return its state as a message, and set states from messages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from irsim.diagnostics.errors import InputError, InputTypeError
from irsim.env.queries import robot
from irsim.env.state import EnvState

if TYPE_CHECKING:
    from irsim.msg import WorldState

__all__ = ["get_msg", "receive_msg", "resolve_message_targets"]


def get_msg(env: EnvState, use_inf: bool = False) -> WorldState:
    """Return a message with the present state of every object.

    Args:
        use_inf: Report +inf as the range of beams that hit nothing, and -inf for hits nearer than ``range_min``.
    """
    from irsim.msg import WorldState

    return WorldState.from_env(env, use_inf=use_inf)


def receive_msg(
    env: EnvState, msg: Any, *, object_name: str | None = None, object_id: int | None = None, refresh: bool = True
) -> int:
    """Set the poses and velocities of objects from a message.

    Args:
        msg: A ``WorldState``, an ``ObjectState``, or odometry, which is any object with ``pose.pose`` and
            ``twist.twist``, such as a native ROS message.
        object_name: Name of the object to set; by default the name and id in the message, for odometry the first robot.
        object_id: Id of the object to set, instead of its name.
        refresh: Also update collisions and sensors.

    Returns:
        Number of objects that were set.

    Raises:
        ValueError: An object does not exist, or a number is not finite; then no object has been changed.
        TypeError: ``msg`` is not a valid message.
    """
    from irsim.msg.messages import state_and_control

    pairs = resolve_message_targets(env._objects, msg, object_name, object_id, default_target=lambda: robot(env))
    changes = [(view, *state_and_control(view, odometry)) for view, odometry in pairs]
    for view, state, velocity in changes:
        view.set_state(state)
        if velocity is not None:
            view.set_velocity(velocity)
    if refresh:
        env._simulation.refresh()
    return len(changes)


def resolve_message_targets(
    objects: Sequence[Any],
    msg: Any,
    object_name: str | None = None,
    object_id: int | None = None,
    *,
    default_target: Any,
) -> list[tuple[Any, Any]]:
    """Find the objects that a message refers to.

    Args:
        objects: All objects of the environment.
        msg: ``WorldState``, ``ObjectState`` or odometry.
        object_name: Name of the object, in place of the name in the message.
        object_id: Id of the object, in place of the id in the message.
        default_target: Function that returns the object for odometry without a name.

    Returns:
        A pair of object and odometry for each object in the message.

    Raises:
        ValueError: No object has that name or id.
        TypeError: ``msg`` is not a valid message.
    """
    if hasattr(msg, "objects"):
        return [(_named(objects, state.name, state.id), state.odom) for state in msg.objects]
    odometry = getattr(msg, "odom", msg)
    if object_name is not None or object_id is not None:
        return [(_named(objects, object_name, object_id), odometry)]
    if odometry is not msg:
        return [(_named(objects, msg.name, msg.id), odometry)]
    if not (hasattr(odometry, "pose") and hasattr(odometry, "twist")):
        raise InputTypeError(
            f"a message has pose.pose and twist.twist, like odometry of ROS; this is {type(msg).__name__}"
        )
    return [(default_target(), odometry)]


def _named(objects: Sequence[Any], name: str | None, object_id: int | None) -> Any:
    by_name = [view for view in objects if name is not None and view.name == name]
    by_id = [view for view in objects if object_id is not None and view.id == object_id]
    matches = by_name or by_id
    if not matches:
        raise InputError(f"no object has the name {name!r} or the id {object_id!r} of this message")
    return matches[0]
