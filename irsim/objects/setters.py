"""Attributes of objects and sensors that scripts may write at run time, and the effect of a write.

A write either takes effect in the engine at once or raises an error that says what to call instead. Writing a setting
of an object replaces the record of the object in the engine and changes nothing else. Settings survive ``reset``.
``reload`` restores those of the file, as does the next scene if objects have been added or deleted.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from pydantic import ValidationError

from irsim.components.behaviors._options import behavior_fields

if TYPE_CHECKING:
    from irsim.objects.base import SimObject

__all__ = ["HINTS", "BehaviorKeys", "FixedList", "behavior_keys", "change", "refuse", "sensor_options"]

_CHOICES = {"role": ("robot", "obstacle"), "arrive_mode": ("position", "state")}


def _flag(view: SimObject, name: str, value: Any) -> bool:
    if not isinstance(value, (bool, np.bool_, int)):
        raise TypeError(f"{name!r} of {view.name!r} is True or False, not {value!r}")
    return bool(value)


def _length(view: SimObject, name: str, value: Any) -> float:
    number = float(value)
    if not (math.isfinite(number) and number >= 0):
        raise ValueError(f"{name!r} of {view.name!r} is a number of at least 0, not {value!r}")
    return number


def _optional(view: SimObject, name: str, value: Any) -> float | None:
    return None if value is None else _length(view, name, value)


def _choice(view: SimObject, name: str, value: Any) -> str:
    if value not in _CHOICES[name]:
        raise ValueError(f"{name!r} of {view.name!r} is {' or '.join(map(repr, _CHOICES[name]))}, not {value!r}")
    return str(value)


def _limits(view: SimObject, name: str, value: Any) -> list[float]:
    numbers = np.asarray(value, dtype=np.float64).reshape(-1)
    if numbers.size != view.vel_dim or np.isnan(numbers).any():
        raise ValueError(f"{name!r} of {view.name!r} is {view.vel_dim} numbers, not {value!r}")
    if name == "acce" and (numbers < 0).any():
        raise ValueError(f"'acce' of {view.name!r} must not be negative: {value!r}")
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
    "state": "call `set_state`",
    "position": "call `set_state`",
    "orientation": "call `set_state`",
    "heading": "call `set_state`",
    "init_state": "call `set_state(..., init=True)`",
    "velocity": "call `set_velocity`",
    "velocity_xy": "call `set_velocity`",
    "goal": "call `set_goal`",
    "goals": "call `set_goal` or `append_goal`",
    "trajectory": "it follows from the steps; `reset` clears it",
    "arrive": "set `arrive_flag`",
    "collision": "set `collision_flag`",
    "max_speed": "set `vel_max`",
    "wheelbase": "it belongs to the shape in the scenario",
    "shape": "call `set_original_geometry`, or give `shape` in the scenario",
    "geometry": "call `set_original_geometry`",
    "original_geometry": "call `set_original_geometry`",
    "radius": "call `set_original_geometry`",
    "vertices": "call `set_original_geometry`",
    "kinematics": "give `kinematics` in the scenario, or make another object with `env.create_robot`",
    "kf": "give `kinematics` in the scenario; drives of your own are registered with `register_kinematics`",
    "gf": "call `set_original_geometry`",
    "obj_behavior": "write into `beh_config`, or replace `gen_behavior_vel`",
    "group_behavior_dict": "give `group_behavior` in the scenario",
    "sensors": "give `sensors` in the scenario, or to `env.create_robot`",
    "lidar": "give `sensors` in the scenario; `range_max`, `noise`, ... of the lidar may be set",
    "state_dim": "give `state_dim` in the scenario",
    "state_shape": "give `state_dim` in the scenario",
    "vel_dim": "give `vel_dim` in the scenario",
    "vel_shape": "give `vel_dim` in the scenario",
    "info": "it is a snapshot: set the attributes of the object",
    "plot_kwargs": "write into it",
    "mass": "give `mass` in the scenario",
    "friction": "give `friction` in the scenario",
    "restitution": "give `restitution` in the scenario",
    "inertia": "give `inertia` in the scenario",
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
        view._simulation.control[view.row] = 0.0
        view._simulation.twist[view.row] = 0.0


# behaviors -----------------------------------------------------------------------------------------------------------
class BehaviorKeys(dict[str, Any]):
    """Keys of a behavior as a dictionary; a change takes effect at the next decision.

    Args:
        keys: The keys.
        apply: Function that applies the keys after a change and returns the keys in force. If it raises, nothing is
            changed.
    """

    def __init__(self, keys: Mapping[str, Any], apply: Callable[[dict[str, Any]], dict[str, Any]]) -> None:
        super().__init__(keys)
        self._apply = apply

    def assign(self, keys: Mapping[str, Any] | None) -> None:
        """Replace all keys."""
        held = self._apply(dict(keys or {}))
        super().clear()
        super().update(held)

    def _changed(self, method: str, *args: Any, **kwargs: Any) -> Any:
        new = dict(self)
        result = getattr(new, method)(*args, **kwargs)
        if new != dict(self):
            self.assign(new)
        return result

    def __setitem__(self, key: str, value: Any) -> None:
        self._changed("__setitem__", key, value)

    def __delitem__(self, key: str) -> None:
        self._changed("__delitem__", key)

    def __ior__(self, other: Any) -> BehaviorKeys:  # type: ignore[override,misc]
        self._changed("update", other)
        return self

    def update(self, *args: Any, **kwargs: Any) -> None:
        """Do what the method of ``dict`` does, and apply the change."""
        self._changed("update", *args, **kwargs)

    def pop(self, *args: Any) -> Any:
        """Do what the method of ``dict`` does, and apply the change."""
        return self._changed("pop", *args)

    def popitem(self) -> tuple[str, Any]:
        """Do what the method of ``dict`` does, and apply the change."""
        item: tuple[str, Any] = self._changed("popitem")
        return item

    def clear(self) -> None:
        """Do what the method of ``dict`` does, and apply the change."""
        self._changed("clear")

    def setdefault(self, *args: Any) -> Any:
        """Do what the method of ``dict`` does, and apply the change."""
        return self._changed("setdefault", *args)

    def copy(self) -> dict[str, Any]:
        """Return the keys as a plain dictionary."""
        return dict(self)

    def __reduce__(self) -> Any:
        return dict, (dict(self),)


def behavior_keys(view: SimObject) -> BehaviorKeys:
    """Return the keys of the behavior of an object, which may be written, or else those of its group behavior."""

    def present() -> dict[str, Any]:
        options = view.record.behavior or view.record.group_behavior
        return {} if options is None else options.model_dump(exclude_unset=True)

    def apply(new: dict[str, Any]) -> dict[str, Any]:
        if view.record.behavior is None and view.record.group_behavior is not None:
            refuse(repr(view.name), "beh_config", HINTS["group_behavior_dict"])
        _set_behavior(view, new)
        return present()

    return BehaviorKeys(present(), apply)


def _set_behavior(view: SimObject, keys: dict[str, Any]) -> None:
    """Replace the behavior of an object by one with the keys of a scenario.

    Raises:
        ScenarioError: A key or value is not valid. What IR-SIM would ignore is logged as a warning instead.
    """
    from irsim.scenario.single_object import read_object

    record, world = view.record, view._simulation.scenario.world
    if record.kinematics is None:
        refuse(repr(view.name), "beh_config", "it has no drive, and never moves by itself")
    drive = {"name": str(getattr(record.kinematics, "name", ""))}
    entry = {"kinematics": drive, "behavior": keys or None}
    made, found = read_object(record.role, entry, world, record.id)
    for item in found:
        if "behavior" in item.path and view.logger is not None:
            view.logger.warning(f"{record.name}: {item.message} [{item.code}]")
    view.amend(replace(record, behavior=made.behavior, **behavior_fields(made.behavior, world.bounds)))


# sensors -------------------------------------------------------------------------------------------------------------
def sensor_options(options: Any, owner: str, **changed: Any) -> Any:
    """Return a copy of the options of a sensor with changed values.

    Raises:
        ValueError: A value is not valid.
    """
    given = {key: np.asarray(v).reshape(-1).tolist() if key == "offset" else v for key, v in changed.items()}
    given = {key: v.item() if isinstance(v, np.generic) else v for key, v in given.items()}
    try:
        return type(options).model_validate({**options.model_dump(exclude_unset=True), **given})
    except ValidationError as error:
        (name,) = changed
        raise ValueError(f"{name!r} of {owner}: {error.errors()[0]['msg']}") from None


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
