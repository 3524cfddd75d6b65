"""How much a scenario file may ask for before it is refused."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["DEFAULT_LIMITS", "Limits"]


@dataclass(frozen=True)
class Limits:
    """Upper bounds while reading a scenario; a server passes tighter ones.

    Attributes:
        bytes: Size of the file.
        events: YAML events (scalars, brackets) of the file itself.
        expansion: Events that aliases and merge keys add when they are written out.
        depth: Nesting of lists and mappings, aliases written out.
        objects: Objects of the whole scenario.
        problems: Diagnostics reported for one file.
    """

    bytes: int = 16 * 1024 * 1024
    events: int = 2_000_000
    expansion: int = 500_000
    depth: int = 64
    objects: int = 100_000
    problems: int = 100


DEFAULT_LIMITS = Limits()
