"""Upper bounds on what a scenario may ask for; a scenario above them is refused."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["DEFAULT_LIMITS", "Limits"]


@dataclass(frozen=True)
class Limits:
    """Upper bounds while reading and running a scenario; a server passes tighter ones.

    Attributes:
        bytes: Size of the file.
        events: YAML events (scalars, brackets) of the file itself.
        expansion: Events that aliases and merge keys add when they are written out.
        aliases: Aliases, whatever they refer to.
        depth: Nesting of lists and mappings, aliases written out.
        objects: Objects of the whole scenario.
        robots: Robots among them.
        problems: Diagnostics reported for one file.
        root: Folder that must contain all files named by the scenario; None allows any place.
        steps: Steps of one run; None for no limit. A run with a longer time horizon ends at this step.
        work: Steps times objects of one run; None for no limit.
        cells: Cells of a map.
        map_bytes: Size of a map file.
        bridges: Whether bridges to other programs may be opened.
    """

    bytes: int = 16 * 1024 * 1024
    events: int = 2_000_000
    expansion: int = 500_000
    aliases: int = 1_000_000
    depth: int = 64
    objects: int = 100_000
    robots: int = 100_000
    problems: int = 100
    root: str | None = None
    steps: int | None = None
    work: int | None = None
    cells: int = 64_000_000
    map_bytes: int = 256 * 1024 * 1024
    bridges: bool = True


DEFAULT_LIMITS = Limits()
