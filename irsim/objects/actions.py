"""Actions as scripts write them → controls of objects."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from irsim.objects.base import SimObject

__all__ = ["assign_actions", "beyond_limits"]

_SLACK = 1e-9
"""What rounding may add to a limit."""
Assignments = list[tuple[SimObject, list[float]]]


def _is_one(action: Any) -> bool:
    """Whether ``action`` is one control vector rather than a list of them."""
    if isinstance(action, np.ndarray):
        return True
    return len(action) > 0 and all(isinstance(v, (int, float, np.number)) and not isinstance(v, bool) for v in action)


def _find(objects: Sequence[SimObject], key: Any) -> SimObject:
    if isinstance(key, (int, np.integer)) and not isinstance(key, bool):
        index = int(key)
        if 0 <= index < len(objects) and objects[index].id == index:
            return objects[index]  # nobody was taken out before it
        found = [view for view in objects if view.id == index]
    else:
        found = [view for view in objects if view.name == key]
    if not found:
        names = ", ".join(view.name for view in objects[:8])
        ids = [view.id for view in objects]
        known = f"0 to {len(ids) - 1}" if ids == list(range(len(ids))) else ", ".join(map(str, ids[:20]))
        raise ValueError(f"no object with id or name {key!r}; ids are {known}, names {names}")
    return found[0]


def _control(view: SimObject, action: Any) -> list[float]:
    try:
        values = np.asarray(action, dtype=np.float64).reshape(-1)
    except (TypeError, ValueError):
        raise ValueError(f"an action is numbers, not {action!r}") from None
    if values.size != view.vel_dim:
        kind = view.kinematics or "static"
        raise ValueError(f"{view.name!r} ({kind}) takes {view.vel_dim} numbers per action, got {values.size}")
    if not np.isfinite(values).all():
        raise ValueError(f"the action for {view.name!r} is not finite: {values.tolist()}")
    return list(map(float, values))


def beyond_limits(view: SimObject, control: Sequence[float]) -> bool:
    """Whether limits of speed or acceleration will cut a control."""
    record = view.record
    limits = zip(control, record.vel_min, record.vel_max, strict=True)
    if any(not low - _SLACK <= value <= high + _SLACK for value, low, high in limits):
        return True
    if all(rate == math.inf for rate in record.acce):
        return False
    lowest, highest = view.get_vel_range()
    return bool((np.array(control) < lowest[:, 0] - _SLACK).any() or (np.array(control) > highest[:, 0] + _SLACK).any())


def assign_actions(
    objects: Sequence[SimObject], action: Any, action_id: Any, warn: Callable[[str], None]
) -> Assignments:
    """Which object gets which control.

    Args:
        objects: In the order of their rows; positions count from the first one.
        action: One control vector (list, tuple, 1-D array or column), a list of them (None inside leaves that object to
            its behavior), or a mapping from id or name to vectors.
        action_id: Id or name of the target, or a list of them. A list of actions given with one id goes to that object
            and the following ones. None: the first object, and on from there.
        warn: Told about surplus actions.

    Returns:
        Pairs of object and its control in the command frame.

    Raises:
        TypeError: Not an action at all.
        ValueError: Unknown target, wrong number of numbers, not finite.
    """
    if isinstance(action, Mapping):
        pairs = [(_find(objects, key), value) for key, value in action.items()]
    elif not isinstance(action, (list, tuple, np.ndarray)):
        raise TypeError(f"action must be a list, tuple, ndarray or mapping, got {type(action).__name__}")
    else:
        several_ids = isinstance(action_id, (list, tuple, np.ndarray))
        if several_ids:
            targets = [_find(objects, key) for key in action_id]
        elif action_id is None:
            targets = list(objects)
        else:
            targets = list(objects[objects.index(_find(objects, action_id)) :])
        if _is_one(action):
            pairs = [(view, action) for view in (targets if several_ids else targets[:1])]
        else:
            if len(action) > len(targets):
                warn(f"{len(action)} actions for {len(targets)} object(s): the first ones are used, in order")
            pairs = list(zip(targets, action, strict=False))
    return [(view, _control(view, value)) for view, value in pairs if value is not None]
