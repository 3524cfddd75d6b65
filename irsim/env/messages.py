"""Messages out of an environment, and odometry into it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from irsim import msg
from irsim.env.queries import robot
from irsim.env.state import EnvState
from irsim.msg.messages import state_and_control

__all__ = ["get_msg", "receive_msg", "resolve_message_targets"]


def get_msg(env: EnvState, use_inf: bool = False) -> msg.WorldState:
    """Everything as it is now.

    Args:
        use_inf: Ranges of beams that hit nothing are +inf, of hits nearer than ``range_min`` -inf.
    """
    return msg.WorldState.from_env(env, use_inf=use_inf)


def receive_msg(
    env: EnvState, msg: Any, *, object_name: str | None = None, object_id: int | None = None, refresh: bool = True
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
