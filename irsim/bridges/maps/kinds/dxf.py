"""``dxf``: floor plans in DXF, read in a process of its own: closed outlines and hatches are solid, lines are walls."""

from __future__ import annotations

from pathlib import Path

from irsim.bridges.maps.apart import read_apart
from irsim.bridges.maps.areas import unpacked
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, Outlines

__all__ = ["KIND"]


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Outlines:
    """Outlines of the model space.

    Raises:
        BridgeError: The file is damaged.
    """
    request = {"unit": options.meters_per_unit, "layers": options.layers and list(options.layers)}
    return unpacked(*read_apart(path, f"{__package__}._dxf_process", limits, request))


KIND = Kind(
    name="dxf",
    title="a plan in DXF",
    suffixes=(".dxf",),
    accepts=lambda head: b"SECTION" in head,
    read=read,
    unknown="free",
    extra="plans",
    libraries=("ezdxf",),
    unused=("headroom", "slope", "ground", "climb", "up", "rotate", "level", "height", "opacity", "lanes", "root"),
    by_name=True,
    layered=True,
)
