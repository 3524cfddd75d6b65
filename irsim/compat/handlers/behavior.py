"""Behaviors of one object and of a group: they find what is registered for a drive and a name, and call it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np

from irsim.compat.handlers import built_in
from irsim.objects.extensions.behaviors import call, construct
from irsim.options.registry import CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS

__all__ = [
    "Behavior",
    "GroupBehavior",
    "behaviors_class_map",
    "behaviors_map",
    "group_behaviors_class_map",
    "group_behaviors_map",
]

REGISTERING = built_in
"""The module that registers the built-in behaviors when it is imported."""

behaviors_map = CUSTOM_BEHAVIORS.functions
"""Functions by (kinematics, name)."""
behaviors_class_map = CUSTOM_BEHAVIORS.classes
"""Classes by (kinematics, name); user code alone registers them."""
group_behaviors_map = CUSTOM_GROUP_BEHAVIORS.functions
"""Functions for groups by (kinematics, name); user code alone registers them."""
group_behaviors_class_map = CUSTOM_GROUP_BEHAVIORS.classes
"""Classes for groups by (kinematics, name)."""


def _print_error(text: str) -> None:
    """Print a message to standard error, as handlers without an environment do."""
    print(text, file=sys.stderr)


class Behavior:
    """The behavior of one object.

    Args:
        object_info: Description of the object, ``ObjectInfo``.
        behavior_dict: The YAML mapping: ``name`` and the keys of the behavior.
    """

    def __init__(self, object_info: Any = None, behavior_dict: Mapping[str, Any] | None = None) -> None:
        self.object_info = object_info
        self._keys: dict[str, Any] = dict(behavior_dict or {})
        self._made: Callable[..., Any] | None = None
        self._construct()

    @property
    def behavior_dict(self) -> dict[str, Any]:
        """Keys of the behavior: the ``beh_config`` of the object itself, so that changes take effect at once."""
        return self._keys

    @behavior_dict.setter
    def behavior_dict(self, keys: Mapping[str, Any] | None) -> None:
        assign = getattr(self._keys, "assign", None)
        if assign is not None:
            assign(keys)
        else:
            self._keys = dict(keys or {})

    def follow(self, keys: dict[str, Any]) -> None:
        """Use this dictionary of keys itself, so that later changes of it take effect."""
        self._keys = keys

    def _construct(self) -> None:
        name = self.behavior_dict.get("name")
        maker = behaviors_class_map.get((getattr(self.object_info, "kinematics", None) or "", name or ""))
        self._made = None
        if maker is not None:
            self._made = construct(maker, self.object_info, self.behavior_dict, "behavior class", _print_error)

    def gen_vel(self, ego_object: Any, external_objects: Any = None) -> Any:
        """Return the control that the behavior chooses.

        Args:
            ego_object: The object.
            external_objects: The other objects that it sees.

        Returns:
            (vel_dim, 1) in the command frame; zero without a behavior.

        Raises:
            ValueError: Nothing is registered for this drive and name.
        """
        if not self.behavior_dict:
            return np.zeros((ego_object.vel_dim, 1))
        keys = self.behavior_dict
        act = self._made or partial(self.invoke_behavior, ego_object.kinematics, keys["name"])
        return call(act, ego_object, external_objects or (), keys.get("target_roles", "all"), keys)

    def load_behavior(self, behaviors: str = ".behavior_methods") -> None:
        """Import a module, which registers its behaviors; a leading dot means this package."""
        import_module(behaviors, package="irsim.lib.behavior")
        self._construct()

    def invoke_behavior(self, kinematics: str, action: str, **kwargs: Any) -> Any:
        """Call the function registered for a drive and a name.

        Raises:
            ValueError: No function is registered for them.
        """
        function = behaviors_map.get((kinematics, action))
        if function is None:
            known = sorted(name for drive, name in behaviors_map if drive == kinematics)
            raise ValueError(f"no behavior {action!r} is registered for {kinematics!r}; there are {', '.join(known)}")
        return function(**kwargs)


class GroupBehavior:
    """A behavior that chooses the controls of all members of a group together.

    Args:
        members: The group; the drive of the first one counts.
        **behavior_dict: The YAML mapping: ``name`` and the keys of the behavior.
    """

    def __init__(self, members: Sequence[Any], **behavior_dict: Any) -> None:
        self.members = list(members)
        self.behavior_dict = behavior_dict
        self.kinematics = self.members[0].kinematics if self.members else None
        self.name = behavior_dict.get("name")
        self._made: Callable[..., Any] | None = None
        self._construct()

    def _construct(self) -> None:
        key = (self.kinematics or "static", self.name or "")
        maker = group_behaviors_class_map.get(key)
        self._made = None
        if maker is None:
            if self.name is not None and key not in group_behaviors_map:
                _print_error(f"group behavior {self.name!r} is not registered for {self.kinematics!r}")
            return
        self._made = construct(maker, self.members, self.behavior_dict, "group behavior", _print_error)

    def update_members(self, members: Sequence[Any]) -> None:
        """Replace the members of the group."""
        self.members = list(members)

    def load_group_behaviors(self, group_behaviors: str = ".group_behavior_methods") -> None:
        """Import a module, which registers its behaviors; a leading dot means this package."""
        import_module(group_behaviors, package="irsim.lib.behavior")
        self._construct()

    def gen_group_vel(self) -> list[Any]:
        """Return one control per member, (vel_dim, 1); a member whose entry is None follows its own behavior."""
        act = self._made or group_behaviors_map.get((self.kinematics or "static", self.name or ""))
        if act is None or not self.members:
            return [None] * len(self.members)
        return list(act(self.members, **self.behavior_dict))
