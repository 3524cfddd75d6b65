"""Converts actions as scripts write them into controls of objects."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from irsim.common.arguments import as_given
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import InputError, InputTypeError
from irsim.objects.base import SimObject

__all__ = ["assign_actions"]

Assignments = list[tuple[SimObject, Sequence[float]]]


def _is_one(action: Any) -> bool:
    """Whether ``action`` is one control vector rather than a list of them."""
    if isinstance(action, np.ndarray):
        return True
    for value in action:
        if type(value) is not float and (isinstance(value, bool) or not isinstance(value, (int, float, np.number))):
            return False
    return len(action) > 0


def _find(objects: Sequence[SimObject], key: Any) -> SimObject:
    if isinstance(key, (int, np.integer)) and not isinstance(key, bool):
        index = int(key)
        if 0 <= index < len(objects) and objects[index].id == index:
            return objects[index]  # no earlier object was deleted
        matches = [view for view in objects if view.id == index]
    else:
        matches = [view for view in objects if view.name == key]
    if not matches:
        names = ", ".join(view.name for view in objects[:8])
        ids = [view.id for view in objects]
        known = f"0 to {len(ids) - 1}" if ids == list(range(len(ids))) else ", ".join(map(str, ids[:20]))
        fix = suggestion(key, [view.name for view in objects], f"ids are {known}, names {names}")
        raise InputError(f"no object with id or name {key!r}", fix, "action", [view.name for view in objects])
    return matches[0]


def _plain_control(view: SimObject, action: Any) -> Sequence[float] | None:
    """Return an action that is the finite floats of one control; None for forms that `_checked_control` converts.

    NumPy would take longer for them than a step of a small world.
    """
    numbers = action.tolist() if type(action) is np.ndarray else action
    if not isinstance(numbers, (list, tuple)) or len(numbers) != view.vel_dim:
        return None
    for value in numbers:
        if type(value) is not float or not math.isfinite(value):
            return None
    return numbers


def _control(view: SimObject, action: Any) -> Sequence[float]:
    plain = _plain_control(view, action)
    return _checked_control(view, action) if plain is None else plain


def _checked_control(view: SimObject, action: Any) -> list[float]:
    """Convert an action of any type."""
    try:
        values = np.asarray(action, dtype=np.float64).reshape(-1)
    except (OverflowError, TypeError, ValueError):
        raise InputError(f"an action is numbers, not {as_given(action)}", where="action") from None
    if values.size != view.vel_dim:
        kind = view.kinematics or "static"
        what = f"{view.name!r} ({kind}) takes {view.vel_dim} numbers per action, got {values.size}"
        raise InputError(what, where="action")
    if not np.isfinite(values).all():
        raise InputError(f"the action for {view.name!r} is not finite: {values.tolist()}", where="action")
    return list(map(float, values))


def assign_actions(
    objects: Sequence[SimObject], action: Any, action_id: Any, warn: Callable[[str], None]
) -> Assignments:
    """Assign the controls of an action to objects.

    Args:
        objects: All objects, in the order of their rows.
        action: One control vector (list, tuple, 1-D array or column), a list of them (None inside leaves that object to
            its behavior), or a mapping from id or name to vectors.
        action_id: Id or name of the target, or a list of them. With one id, a list of actions goes to that object and
            the objects after it. None stands for the first object.
        warn: Function that is called with a message about surplus actions.

    Returns:
        Pairs of object and its control in the command frame.

    Raises:
        InputTypeError: ``action`` is not a valid type of action.
        InputError: A target does not exist, or a control has the wrong size or is not finite.
    """
    if action_id is None and objects and (numbers := _plain_control(objects[0], action)) is not None:
        return [(objects[0], numbers)]
    if not isinstance(action, (list, tuple, np.ndarray)):
        if not isinstance(action, Mapping):
            what = f"action must be a list, tuple, ndarray or mapping, got {type(action).__name__}"
            raise InputTypeError(what, where="action")
        pairs = [(_find(objects, key), value) for key, value in action.items()]
    elif (one := _is_one(action)) and action_id is None:
        pairs = [(view, action) for view in objects[:1]]
    else:
        several_ids = isinstance(action_id, (list, tuple, np.ndarray))
        if several_ids:
            targets = [_find(objects, key) for key in action_id]
        elif action_id is None:
            targets = list(objects)
        else:
            targets = list(objects[objects.index(_find(objects, action_id)) :])
        if one:
            pairs = [(view, action) for view in (targets if several_ids else targets[:1])]
        else:
            if len(action) > len(targets):
                warn(f"{len(action)} actions for {len(targets)} object(s): the first ones are used, in order")
            pairs = list(zip(targets, action, strict=False))
    return [(view, _control(view, value)) for view, value in pairs if value is not None]
