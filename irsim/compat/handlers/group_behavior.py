"""The behavior of a group: finds the function or class registered for its drive and name, and calls it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any

from irsim.compat.handlers.behavior import print_error
from irsim.compat.handlers.behavior_maps import group_behaviors_class_map, group_behaviors_map
from irsim.objects.extensions.behaviors import construct

__all__ = ["GroupBehavior"]


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
                print_error(f"group behavior {self.name!r} is not registered for {self.kinematics!r}")
            return
        self._made = construct(maker, self.members, self.behavior_dict, "group behavior", print_error)

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
