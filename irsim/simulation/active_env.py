"""Which environment was used last: what the names of ``irsim.config`` and ``irsim.util.random`` follow.

Nothing in the engine reads it; it exists for scripts that use those names (difference D8).
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import ReferenceType, ref

if TYPE_CHECKING:
    from irsim.env import Env

__all__ = ["last_used", "use"]

_LAST: list[ReferenceType[Env]] = []


def use(env: Env) -> None:
    """Remember ``env`` as the one used last; it is not kept alive."""
    _LAST[:] = [ref(env)]


def last_used() -> Env | None:
    """The environment used last, None before the first one and after it is gone."""
    return _LAST[0]() if _LAST else None
