"""``opendrive``: roads of ASAM OpenDRIVE (``.xodr``): lanes for vehicles, or for pedestrians, are free."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from irsim.bridges.maps.grid import Triangles
from irsim.bridges.maps.kinds._road import lane_triangles, read_roads
from irsim.bridges.maps.options import ImportLimits, ImportOptions
from irsim.bridges.maps.source import Kind, Scene, unusable

__all__ = ["KIND"]

DRIVE = frozenset({
    "driving", "bidirectional", "entry", "exit", "onRamp", "offRamp", "connectingRamp", "slipLane", "mwyEntry",
    "mwyExit", "taxi", "bus", "HOV", "parking",
})  # fmt: skip
"""Types of lanes for vehicles (OpenDRIVE 1.7, section 9.5); stop and shoulder are not among them."""
WALK = frozenset({"sidewalk", "walking", "biking"})
"""Types of lanes for pedestrians."""
_HEADROOM = 2.5
"""Roads whose heights differ by less are at one place [m]."""
_CLIMB = 0.3
"""Difference of height between lanes side by side that is one level [m]."""


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Scene:
    """Lanes of all roads.

    Raises:
        BridgeError: The file is damaged, or has no lanes.
    """
    wanted = {"drive": DRIVE, "walk": WALK, "all": DRIVE | WALK}[options.lanes]
    free: list[Triangles] = []
    barred: list[Triangles] = []
    seen: set[str] = set()
    total = 0
    for road in read_roads(path):
        for kind, triangles in lane_triangles(path, road):
            total += len(triangles)
            if total > limits.triangles:
                raise unusable(path, f"its lanes need more than {limits.triangles:,} triangles", "cut the road network")
            seen.add(kind)
            if kind in wanted:
                free.append(triangles)
            elif kind != "none":
                barred.append(triangles)
    if not sum(map(len, free)):
        listed = ", ".join(sorted(seen)) or "none"
        raise unusable(path, f"it has no lanes to {options.lanes}; its lanes are: {listed}", "try --lanes all")
    notes = [] if options.lanes == "all" else [f"free are lanes to {options.lanes}; others are occupied"]
    return Scene(
        "irsim",
        floors=np.concatenate(free),
        barred=np.concatenate(barred) if barred else np.zeros((0, 3, 3)),
        headroom=_HEADROOM,
        climb=_CLIMB,
        notes=notes,
    )


def _may_be_roads(head: bytes) -> bool:
    return b"OpenDRIVE" in head or b"O\0p\0e\0n\0D\0R\0I\0V\0E" in head or head.lstrip()[:5] in (b"<?xml", b"<!DOC")


KIND = Kind(
    name="opendrive",
    title="a road network of OpenDRIVE",
    suffixes=(".xodr",),
    accepts=_may_be_roads,
    read=read,
    unused=("slope", "up", "meters_per_unit", "opacity"),
)
