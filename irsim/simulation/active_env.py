"""Which environment was used last: the names of ``irsim.config`` and ``irsim.util.random`` follow it.

Nothing in the engine reads it; it exists for scripts that use those names (difference D8). Environments made without a
seed take the seeds that ``irsim.util.random.set_seed`` determined, if a script has called it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from types import ModuleType
from typing import Any
from weakref import ReferenceType, ref

import numpy as np

__all__ = ["current_rng", "follow", "last_used", "next_seed", "seed_next", "set_current_rng", "use"]


_LAST: list[ReferenceType[Any]] = []
_OUTSIDE: list[np.random.Generator] = []
"""The generator of scripts without an environment; made on first use, as NumPy's generators take long to import."""

_SEEDS: list[Iterator[int]] = []
"""Seeds of the next environments that are made without one; empty unless a script has determined them."""


def use(env: Any) -> None:
    """Remember an environment as the one used last, without keeping it alive."""
    if last_used() is not env:
        _LAST[:] = [ref(env)]


def last_used() -> Any:
    """The environment used last; None before the first one and after it is gone."""
    return _LAST[0]() if _LAST else None


def current_rng() -> Any:
    """The generator of the environment used last; without one, a generator with a fresh seed."""
    env = last_used()
    if env is not None:
        return env.rng
    if not _OUTSIDE:
        _OUTSIDE.append(np.random.default_rng())
    return _OUTSIDE[0]


def set_current_rng(generator: np.random.Generator) -> None:
    """Replace the generator that :func:`current_rng` returns."""
    env = last_used()
    if env is None:
        _OUTSIDE[:] = [generator]
    else:
        env.simulation.set_rng(generator)


def seed_next(seed: int) -> None:
    """Determine the seeds of environments that are made without one: the first has this seed, others follow from it."""

    def seeds() -> Iterator[int]:
        yield seed
        rng = np.random.default_rng(seed)
        while True:
            yield int(rng.integers(2**63))

    _SEEDS[:] = [seeds()]


def next_seed() -> int | None:
    """The seed of an environment that is made without one; None unless :func:`seed_next` has determined it."""
    return next(_SEEDS[0]) if _SEEDS else None


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
    target = sys.modules[module]
    target.__dict__.update(_parameters=parameters, _default=default, _bound=None)
    target.__class__ = _Following
