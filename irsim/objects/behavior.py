"""The behavior of an object as keys that scripts may write, and the range of its random goals."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from irsim.components.options import behavior_fields
from irsim.objects.base import SimObject
from irsim.objects.setters import HINTS, refuse
from irsim.scenario.single_object import read_object

__all__ = ["BehaviorKeys", "ObjectBehavior"]


class ObjectBehavior:
    """The behavior of one object, ``robot.behavior``."""

    def __init__(self, view: SimObject) -> None:
        self._object = view
        self._keys: BehaviorKeys | None = None

    @property
    def keys(self) -> BehaviorKeys:
        """Keys of the behavior as written, which may be set, or else keys of the group behavior."""
        if self._keys is None:
            self._keys = BehaviorKeys(self._present(), self._apply)
        return self._keys

    @keys.setter
    def keys(self, keys: Mapping[str, Any] | None) -> None:
        self.keys.assign(keys)

    @property
    def group_keys(self) -> dict[str, Any]:
        """Keys of the group behavior as written in the scenario; empty without one."""
        options = self._object.record.group_behavior
        return {} if options is None else options.model_dump(exclude_unset=True)

    @property
    def range_low(self) -> list[float]:
        """Lower bounds of random goals: x, y [m], heading [rad]."""
        return list(self._object.record.range_low)

    @property
    def range_high(self) -> list[float]:
        """Upper bounds of random goals: x, y [m], heading [rad]."""
        return list(self._object.record.range_high)

    def _present(self) -> dict[str, Any]:
        options = self._object.record.behavior or self._object.record.group_behavior
        return {} if options is None else options.model_dump(exclude_unset=True)

    def _apply(self, new: dict[str, Any]) -> dict[str, Any]:
        record = self._object.record
        if record.behavior is None and record.group_behavior is not None:
            refuse(repr(record.name), "beh_config", HINTS["group_behavior_dict"])
        _set_behavior(self._object, new)
        return self._present()


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


def _set_behavior(view: SimObject, keys: dict[str, Any]) -> None:
    """Replace the behavior of an object by one with the keys of a scenario.

    Raises:
        ScenarioError: A key or value is not valid. A key that IR-SIM would ignore is logged as a warning instead.
    """
    record, world = view.record, view._simulation.scenario.world
    if record.kinematics is None:
        refuse(repr(view.name), "beh_config", "it has no drive, and never moves by itself")
    drive = {"name": str(getattr(record.kinematics, "name", ""))}
    entry = {"kinematics": drive, "behavior": keys or None}
    made, findings = read_object(record.role, entry, world, record.id)
    env = view._simulation.owner()
    for item in findings if env is not None else ():
        if "behavior" in item.path:
            env.logger.warning(f"{record.name}: {item.message} [{item.code}]")
    view.amend(replace(record, behavior=made.behavior, **behavior_fields(made.behavior, world.bounds)))
