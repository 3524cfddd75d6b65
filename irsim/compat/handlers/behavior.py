"""The behavior of one object: finds the function or class registered for its drive and name, and calls it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np

from irsim.compat.handlers.behavior_maps import behaviors_map
from irsim.objects.extensions.behaviors import call, construct
from irsim.options.registry import CUSTOM_BEHAVIORS

__all__ = ["Behavior", "print_error"]


def print_error(text: str) -> None:
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
        maker = CUSTOM_BEHAVIORS.classes.get((getattr(self.object_info, "kinematics", None) or "", name or ""))
        self._made = None
        if maker is not None:
            self._made = construct(maker, self.object_info, self.behavior_dict, "behavior class", print_error)

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
