"""Attributes of objects and sensors that scripts may write at run time, and the effect of a write.

A write either takes effect in the engine at once or raises an error that says what to call instead. Writing a setting
of an object replaces the record of the object in the engine and changes nothing else. Settings survive ``reset``.
``reload`` restores the settings of the file, as does the next scene if objects have been added or deleted.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from pydantic import ValidationError

from irsim.diagnostics.errors import InputError, InputTypeError
from irsim.scenario.messages.translate import option_problems

if TYPE_CHECKING:
    from irsim.objects.base import SimObject

__all__ = [
    "HINTS",
    "SETTINGS",
    "FixedList",
    "change",
    "changed_options",
    "goal_list",
    "names_only_read",
    "refuse",
    "set_state",
    "set_velocity",
]

_CHOICES = {"role": ("robot", "obstacle"), "arrive_mode": ("position", "state")}


def _flag(view: SimObject, name: str, value: Any) -> bool:
    if not isinstance(value, (bool, np.bool_, int)):
        raise InputTypeError(f"{name!r} of {view.name!r} is True or False, not {value!r}")
    return bool(value)


def _length(view: SimObject, name: str, value: Any) -> float:
    number = float(value)
    if not (math.isfinite(number) and number >= 0):
        raise InputError(f"{name!r} of {view.name!r} is a number of at least 0, not {value!r}")
    return number


def _optional(view: SimObject, name: str, value: Any) -> float | None:
    return None if value is None else _length(view, name, value)


def _choice(view: SimObject, name: str, value: Any) -> str:
    if value not in _CHOICES[name]:
        raise InputError(f"{name!r} of {view.name!r} is {' or '.join(map(repr, _CHOICES[name]))}, not {value!r}")
    return str(value)


def _limits(view: SimObject, name: str, value: Any) -> list[float]:
    numbers = np.asarray(value, dtype=np.float64).reshape(-1)
    if numbers.size != view.vel_dim or np.isnan(numbers).any():
        raise InputError(f"{name!r} of {view.name!r} is {view.vel_dim} numbers, not {value!r}")
    if name == "acce" and (numbers < 0).any():
        raise InputError(f"'acce' of {view.name!r} must not be negative: {value!r}")
    return [float(v) for v in numbers]


def _number(view: SimObject, name: str, value: Any) -> int:
    return int(value)


def _words(view: SimObject, name: str, value: Any) -> tuple[str, ...]:
    return tuple(str(word) for word in value)


def _text(view: SimObject, name: str, value: Any) -> str:
    return str(value)


def _picture(view: SimObject, name: str, value: Any) -> str | None:
    return None if value is None else str(value)


def _color(view: SimObject, name: str, value: Any) -> Any:
    return value


SETTINGS: dict[str, Callable[[Any, str, Any], Any]] = {
    "static": _flag,
    "unobstructed": _flag,
    "wander": _flag,
    "loop": _flag,
    "fov_occlusion": _flag,
    "goal_threshold": _length,
    "fov": _optional,
    "fov_radius": _optional,
    "vel_min": _limits,
    "vel_max": _limits,
    "acce": _limits,
    "role": _choice,
    "arrive_mode": _choice,
    "group": _number,
    "group_name": _text,
    "tags": _words,
    "color": _color,
    "description": _picture,
}
"""Attributes of an object that may be written, each with the function that converts a value for the record."""

HINTS: dict[str, str] = {
    "name": "a name cannot change; give `name` in the scenario, or to `env.create_robot`",
    "id": "ids stay",
    **dict.fromkeys(("state", "position", "orientation", "heading"), "call `set_state`"),
    "init_state": "call `set_state(..., init=True)`",
    **dict.fromkeys(("velocity", "velocity_xy"), "call `set_velocity`"),
    "goal": "call `set_goal`",
    "goals": "call `set_goal` or `append_goal`",
    "trajectory": "it follows from the steps; `reset` clears it",
    "arrive": "set `arrive_flag`",
    "collision": "set `collision_flag`",
    "max_speed": "set `vel_max`",
    "wheelbase": "it belongs to the shape in the scenario",
    "shape": "call `set_original_geometry`, or give `shape` in the scenario",
    **dict.fromkeys(("geometry", "original_geometry", "radius", "vertices", "gf"), "call `set_original_geometry`"),
    "kinematics": "give `kinematics` in the scenario, or make another object with `env.create_robot`",
    "kf": "give `kinematics` in the scenario; drives of your own are registered with `register_kinematics`",
    "obj_behavior": "write into `beh_config`, or replace `gen_behavior_vel`",
    "group_behavior_dict": "give `group_behavior` in the scenario",
    "sensors": "give `sensors` in the scenario, or to `env.create_robot`",
    "lidar": "give `sensors` in the scenario; `range_max`, `noise`, ... of the lidar may be set",
    **dict.fromkeys(("state_dim", "state_shape"), "give `state_dim` in the scenario"),
    **dict.fromkeys(("vel_dim", "vel_shape"), "give `vel_dim` in the scenario"),
    "info": "it is a snapshot: set the attributes of the object",
    "plot_kwargs": "write into it",
    **{name: f"give `{name}` in the scenario" for name in ("mass", "friction", "restitution", "inertia")},
    "external_objects": "call `env.add_object` or `env.delete_object`",
}
"""Attributes of an object that cannot be written, each with advice on what to do instead."""


def refuse(owner: str, name: str, hint: str) -> NoReturn:
    """Raise the error that an attribute cannot be written.

    Raises:
        AttributeError: Always.
    """
    raise AttributeError(f"{name!r} of {owner} cannot be set: {hint}")


def change(view: SimObject, name: str, value: Any) -> None:
    """Set an attribute of :data:`SETTINGS`.

    Raises:
        TypeError, ValueError: The value is not valid.
        AttributeError: The object belongs to a batch.
    """
    given = SETTINGS[name](view, name, value)
    if name in ("wander", "loop") and view.record.kinematics is None:
        refuse(repr(view.name), name, "it has no drive")
    changed = {name: given}
    if name == "fov":
        changed["watches"] = given is not None
    view.amend(replace(view.record, **changed))
    if name == "static" and given:
        view._simulation.set_control(view.row, np.zeros(view.vel_dim))
        view._simulation.twist[view.row] = 0.0


def set_state(view: SimObject, state: Any, init: bool) -> None:
    """Set the state of an object; see :meth:`irsim.objects.view.ObjectView.set_state`."""
    values = np.zeros(view.state_dim) if state is None else np.asarray(state, dtype=np.float64).reshape(-1)
    if values.size != view.state_dim or not np.isfinite(values).all():
        raise InputError(f"the state of {view.name!r} is {view.state_dim} finite numbers, not {state!r}")
    simulation, row = view._simulation, view.row
    simulation.pose[row] = values[:3]
    simulation.extra[row, : view.state_dim - 3] = values[3:]
    if init:
        simulation.state.set_initial(row, pose=True, control=False)
    simulation.state.moved(row)


def set_velocity(view: SimObject, velocity: Any, init: bool) -> None:
    """Set the control of an object; see :meth:`irsim.objects.view.ObjectView.set_velocity`."""
    values = np.zeros(view.vel_dim) if velocity is None else np.asarray(velocity, dtype=np.float64).reshape(-1)
    if values.size != view.vel_dim:
        raise InputError(f"the velocity of {view.name!r} is {view.vel_dim} numbers, not {velocity!r}")
    simulation, row = view._simulation, view.row
    simulation.set_control(row, values)
    simulation.state.rest(row)
    if init:
        simulation.state.set_initial(row, pose=False, control=True)


def goal_list(goal: Any) -> list[list[float]]:
    """Return a goal, or several goals, as a list of goals of 2 or 3 numbers; an empty list for None.

    Raises:
        ValueError: A goal does not have 2 or 3 finite numbers.
    """
    if goal is None:
        return []
    queue = hasattr(goal, "popleft")
    several = isinstance(goal, Sequence) and not isinstance(goal, str) and len(goal) > 0
    if queue or (several and all(isinstance(g, (Sequence, np.ndarray)) and np.size(g) in (2, 3) for g in goal)):
        goals = [np.asarray(g, dtype=np.float64).reshape(-1).tolist() for g in goal]
    else:
        goals = [np.asarray(goal, dtype=np.float64).reshape(-1).tolist()]
    if any(len(g) not in (2, 3) or not all(map(math.isfinite, g)) for g in goals):
        raise InputError(f"a goal is 2 or 3 finite numbers (x, y, theta), not {goal!r}")
    return goals


def names_only_read(cls: type) -> frozenset[str]:
    """Return the names of properties without a setter, parts, and attributes that only records set."""
    return frozenset(name for name in {*HINTS, *dir(cls)} - SETTINGS.keys() if _is_only_read(cls, name))


def _is_only_read(cls: type, name: str) -> bool:
    kind = getattr(cls, name, None)
    return (
        not hasattr(cls, name)
        or isinstance(kind, cached_property)
        or (isinstance(kind, property) and kind.fset is None)
    )


def changed_options(options: Any, owner: str, **changed: Any) -> Any:
    """Return a copy of an options model, of a sensor or of ``plot``, with changed values.

    Raises:
        ValueError: A value is not valid.
    """
    given = {key: np.asarray(v).reshape(-1).tolist() if key == "offset" else v for key, v in changed.items()}
    given = {key: v.item() if isinstance(v, np.generic) else v for key, v in given.items()}
    try:
        return type(options).model_validate({**options.model_dump(exclude_unset=True), **given})
    except ValidationError as error:
        (name,) = changed
        first = option_problems(error, {**options.model_dump(exclude_unset=True), **given}, type(options))[0]
        raise InputError(f"{name!r} of {owner}: {first.message}") from None


class FixedList(list[Any]):
    """A list that can only be read.

    Args:
        items: Elements of the list.
        what: Name of the list in messages.
        hint: Advice, in messages, on what to do instead of changing the list.
    """

    def __init__(self, items: Any = (), what: str = "this list", hint: str = "it can only be read") -> None:
        super().__init__(items)
        self._what, self._hint = what, hint

    def _refused(self, *args: Any, **kwargs: Any) -> NoReturn:
        raise TypeError(f"{self._what} cannot be changed: {self._hint}")

    append = extend = insert = remove = pop = clear = sort = reverse = _refused
    __setitem__ = __delitem__ = __iadd__ = __imul__ = _refused

    def __reduce__(self) -> Any:
        return list, (list(self),)
