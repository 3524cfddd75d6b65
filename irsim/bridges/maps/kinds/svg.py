"""``svg``: floor plans in SVG, read in a process of its own: dark paint stands in the way, white is ground."""

from __future__ import annotations

from pathlib import Path

from irsim.bridges.maps.apart import read_apart
from irsim.bridges.maps.areas import unpacked
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, Outlines

__all__ = ["KIND"]


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Outlines:
    """Outlines of what is painted, as one sees it: what is white covers what was painted before.

    Raises:
        BridgeError: The file is damaged, or refers to another one.
    """
    request = {"unit": options.meters_per_unit, "layers": options.layers and list(options.layers)}
    return unpacked(*read_apart(path, f"{__package__}._svg_process", limits, request))


KIND = Kind(
    name="svg",
    title="a plan in SVG",
    suffixes=(".svg",),
    read=read,
    unknown="free",
    extra="plans",
    libraries=("svgelements",),
    unused=("headroom", "slope", "ground", "climb", "up", "level", "height", "opacity", "lanes", "root"),
    roots=("svg",),
    layered=True,
)
