"""Registration of behaviors by kinematics and name; it loads little, because modules of behaviors import it first."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from irsim.options.registry import CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS

__all__ = [
    "register_behavior",
    "register_behavior_class",
    "register_group_behavior",
    "register_group_behavior_class",
]

Made = TypeVar("Made", bound=Callable[..., Any])


def register_behavior(kinematics: str, action: str) -> Callable[[Made], Made]:
    """Make a function the behavior ``action`` of objects that move by ``kinematics``.

    It is called in each step with ``ego_object``, ``external_objects`` (views) and every key of the YAML mapping, and
    returns the control, ``vel_dim`` numbers in the command frame, which is then limited like any other.

    Raises:
        ValueError: The pair is registered already.
    """
    return _decorator(partial(CUSTOM_BEHAVIORS.register, kinematics, action))


def register_behavior_class(kinematics: str, action: str) -> Callable[[Made], Made]:
    """Make a class, or another factory, the behavior ``action`` of objects that move by ``kinematics``.

    It is called once per object with its ``ObjectInfo`` and every key of the YAML mapping; what it returns is then
    called in each step like a function of :func:`register_behavior`. It wins over functions and built-in behaviors. An
    error in the constructor is logged and the class is not used.

    Raises:
        ValueError: The pair is registered already.
    """
    return _decorator(partial(CUSTOM_BEHAVIORS.register_class, kinematics, action))


def register_group_behavior(kinematics: str, action: str) -> Callable[[Made], Made]:
    """Make a function the group behavior ``action`` of groups whose first member moves by ``kinematics``.

    It is called in each step with the list of members and every key of the first member's YAML mapping, and returns one
    control per member; None leaves a member to its own behavior.

    Raises:
        ValueError: The pair is registered already.
    """
    return _decorator(partial(CUSTOM_GROUP_BEHAVIORS.register, kinematics, action))


def register_group_behavior_class(kinematics: str, action: str) -> Callable[[Made], Made]:
    """Make a class the group behavior ``action``; it is called once with the members and the keys of the YAML mapping.

    Raises:
        ValueError: The pair is registered already.
    """
    return _decorator(partial(CUSTOM_GROUP_BEHAVIORS.register_class, kinematics, action))


def _decorator(register: Callable[[Any], None]) -> Callable[[Made], Made]:
    def add(made: Made) -> Made:
        register(made)
        return made

    return add
