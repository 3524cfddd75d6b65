"""Upper bounds on what a scenario may ask for; a scenario above them is refused."""

from __future__ import annotations

from dataclasses import dataclass

from irsim.common.yaml.limits import YamlLimits

__all__ = ["DEFAULT_LIMITS", "MAX_STEPS", "Limits"]

MAX_STEPS = 100_000_000
"""Most steps of one run."""


@dataclass(frozen=True)
class Limits(YamlLimits):
    """Upper bounds while reading and running a scenario; a server passes tighter ones.

    Those on its text are in :class:`YamlLimits`.

    Attributes:
        objects: Objects of the whole scenario.
        robots: Robots among them.
        root: Folder that must contain all files named by the scenario; None allows any place.
        steps: Steps of one run; None for no limit. A run with a longer time horizon ends at this step.
        work: Steps times objects of one run; None for no limit.
        cells: Cells of a map.
        map_bytes: Size of a map file.
        bridges: Whether bridges to other programs may be opened.
    """

    objects: int = 100_000
    robots: int = 100_000
    root: str | None = None
    steps: int | None = MAX_STEPS
    work: int | None = None
    cells: int = 64_000_000
    map_bytes: int = 256 * 1024 * 1024
    bridges: bool = True


DEFAULT_LIMITS = Limits()
