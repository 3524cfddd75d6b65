"""Modules whose attributes are those of a parameter object of the environment used last."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

from irsim.simulation.active_env import last_used

__all__ = ["follow"]


class _Following(ModuleType):
    """A module that reads and writes the attributes of a parameter object.

    Before the first environment is made, it reads and writes a default object. Names that the parameter object lacks
    are attributes of the module itself.
    """

    _parameters: str
    _default: Any
    _bound: Any

    def _target(self) -> Any:
        bound = self.__dict__.get("_bound")
        if bound is not None:
            return bound
        env = last_used()
        return self.__dict__["_default"] if env is None else getattr(env, self.__dict__["_parameters"])

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        try:
            return getattr(self._target(), name)
        except AttributeError:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}") from None

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and hasattr(self._target(), name):
            setattr(self._target(), name, value)
        else:
            super().__setattr__(name, value)


def follow(module: str, parameters: str, default: Any) -> None:
    """Turn a module into a view of ``env.<parameters>`` of the environment used last.

    Args:
        module: Name of the module.
        parameters: Attribute of the environment that holds the parameter object.
        default: Parameter object that is used before the first environment is made.
    """
    found = sys.modules[module]
    found.__dict__.update(_parameters=parameters, _default=default, _bound=None)
    found.__class__ = _Following
