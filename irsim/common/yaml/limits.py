"""Upper bounds on YAML text."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["YamlLimits"]


@dataclass(frozen=True)
class YamlLimits:
    """Upper bounds while reading a YAML file.

    Attributes:
        bytes: Size of the file.
        events: YAML events (scalars, brackets) of the file itself.
        expansion: Events that aliases and merge keys add when they are written out.
        aliases: Aliases, whatever they refer to.
        keys: Keys of one mapping.
        depth: Nesting of lists and mappings, aliases written out.
        problems: Diagnostics reported for one file.
    """

    bytes: int = 16 * 1024 * 1024
    events: int = 2_000_000
    expansion: int = 500_000
    aliases: int = 1_000_000
    keys: int = 100_000
    depth: int = 64
    problems: int = 100
