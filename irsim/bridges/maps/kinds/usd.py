"""``usd``: stages of OpenUSD, read in a process of its own.

The library is C++ that trusts its files: a damaged one may end the process, and a stage can pull in any other file. The
process has limits of memory and time, and :mod:`irsim.bridges.maps.kinds._usd_layers` looks at the references of the
layers before the stage is opened.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from irsim.bridges.frames import axes_of
from irsim.bridges.maps import slices
from irsim.bridges.maps.apart import read_apart
from irsim.bridges.maps.grid import Triangles, turned
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, Outlined, Outlines, SceneTriangles, unusable
from irsim.common.archives import opened_archive
from irsim.common.records import ContentError
from irsim.common.text import clean

__all__ = ["KIND"]

_MAX_FILES = 10_000
"""Files in a ``.usdz``."""
_MAX_OUTLINED = 10_000
"""Triangles of a stage of irsim beside its upright prisms, up to which outlines are made in seconds; a larger stage is
read as meshes."""
_LISTED = 5
"""Names that a note lists."""


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> SceneTriangles | Outlines:
    """Triangles of the meshes and boxes of a stage that are visible, at the earliest time.

    Of a stage that irsim wrote, outlines of the map and of obstacles that do not drive or walk.

    Raises:
        BridgeError: The stage is damaged, refers to places outside of its folder and the root, or has no meshes.
    """
    if options.up == "-y":
        raise unusable(path, "y does not point down in stages of USD", "give --up y or z, or leave it out")
    if path.suffix.lower() == ".usdz":
        _check_archive(path)
    root = None if options.root is None else str(Path(options.root).resolve())
    request = {"up": options.up, "unit": options.meters_per_unit, "root": root}
    triangles, answer = read_apart(path, f"{__package__}._usd_process", limits, request)
    scale, frame = float(answer["meters_per_unit"]), answer["frame"]
    if not np.isfinite(triangles).all():
        raise unusable(path, "some of its points are not numbers")
    if not len(triangles):
        why = "; ".join(["it has no visible meshes", *answer["notes"]])
        raise unusable(path, why, "export the stage with its meshes, not only references")
    triangles, turn = turned(triangles, options.rotate, axes_of(frame))
    exact = answer["own"] is not None and turn is None
    outlines = _outlines(triangles, answer["own"], options) if exact else None
    if outlines is None or not outlines.things:
        return SceneTriangles(frame, triangles, meters_per_unit=scale, notes=answer["notes"], turn=turn)
    given = next((name for name in ("level", "ground") if getattr(options, name) is not None), None)
    if given is not None:
        raise unusable(path, "irsim wrote it, and it has one floor, the ground", f"leave out --{given}")
    outlines.frame, outlines.meters_per_unit = frame, scale
    outlines.notes += answer["notes"]
    return outlines


def _outlines(triangles: Triangles, parts: list[tuple[Any, ...]], options: ImportOptions) -> Outlines | None:
    """Outlines of all that stands on the ground of a stage that irsim wrote, with the area that it had in irsim.

    Args:
        triangles: (T, 3, 3) corners [m].
        parts: Room, name, number of triangles and disk (None for other shapes) of one part after the other.
        options: How the import is done.

    Returns:
        None if that would take minutes.
    """
    low = (options.height or 0.0) + options.climb
    high = low - options.climb + options.headroom
    result = Outlines([], height=options.height or 0.0)
    moving = set[str]()
    end = others = 0
    for room, name, count, disk in parts:
        part, end = triangles[end : end + count], end + count
        if room == "Ground":
            (left, lower), (right, upper) = part.min(axis=(0, 1))[:2], part.max(axis=(0, 1))[:2]
            result.ground = (float(left), float(lower), float(right), float(upper))
        elif room in ("Robots", "Pedestrians"):
            moving.add(name)
        else:
            upright, region = slices.slice_of_prisms(part, low, high)
            if not upright:
                others += count
                if others > _MAX_OUTLINED:
                    return None
                region = slices.slice_of_mesh(part, low, high)
            if region is not None:
                result.things.append(Outlined(name, region, None if disk is None else tuple(disk)))
    if moving:
        listed = ", ".join(clean(name, 80) for name in sorted(moving)[:_LISTED])
        more = ", …" if len(moving) > _LISTED else ""
        result.notes.append(f"left out, as they move: {len(moving)} of its robots and people ({listed}{more})")
    return result


def _check_archive(path: Path) -> None:
    """A ``.usdz`` stores its files uncompressed, so that it cannot grow when it is read."""
    try:
        size = path.stat().st_size
        with opened_archive(path, most_bytes=size, most_entries=_MAX_FILES, packed=False) as archive:
            names = archive.namelist()
    except ContentError as error:
        place = f" (its file '{error.place}')" if error.place else ""
        raise unusable(path, f"it is not an archive of usdz: {error.message}{place}") from None
    outside = next((name for name in names if name.startswith(("/", "\\")) or ".." in Path(name).parts), None)
    if outside is not None:
        raise unusable(path, f"its file '{outside[:80]}' lies outside of it")


KIND = Kind(
    name="usd",
    title="a stage of OpenUSD",
    suffixes=(".usd", ".usda", ".usdc", ".usdz"),
    accepts=lambda head: head.startswith((b"PXR-USDC", b"#usda", b"PK\x03\x04")),
    read=read,
    extra="usd",
    libraries=("pxr",),
    unused=("opacity", "lanes"),
)
