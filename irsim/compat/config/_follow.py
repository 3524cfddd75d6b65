"""A module whose attributes are those of a parameter object of the environment used last."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

from irsim.simulation.active_env import last_used

__all__ = ["follow"]


class _Following(ModuleType):
    """Reads and writes the parameter object; before the first environment, and for other names, itself."""

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
    """Let a module show ``env.<parameters>`` of the environment used last, ``default`` before there is one."""
    found = sys.modules[module]
    found.__dict__.update(_parameters=parameters, _default=default, _bound=None)
    found.__class__ = _Following
