"""Registration of behaviors by kinematics and name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from irsim.registry import CUSTOM_BEHAVIORS

__all__ = ["register_behavior"]

Function = Callable[..., Any]


def register_behavior(kinematics: str, name: str) -> Callable[[Function], Function]:
    """Make a function the behavior ``name`` of objects that move by ``kinematics``.

    It is called in each step with ``ego_object``, ``external_objects`` (views) and every key of the YAML mapping, and
    returns the control, ``vel_dim`` numbers in the command frame, which is then limited like any other.

    Raises:
        ValueError: The pair is registered already.
    """

    def add(function: Function) -> Function:
        CUSTOM_BEHAVIORS.register(kinematics, name, function)
        return function

    return add
