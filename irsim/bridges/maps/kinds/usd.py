"""``usd``: stages of OpenUSD, read in a process of its own.

The library is C++ that trusts its files: a damaged one may end the process, and a stage can pull in any other file. The
process has limits of memory and time, and :mod:`irsim.bridges.maps.kinds._usd_layers` looks at the references of the
layers before the stage is opened.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from irsim.bridges.maps.apart import read_apart
from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, Scene, unusable
from irsim.common.archives import opened_archive
from irsim.common.records import ContentError

__all__ = ["KIND"]

_MAX_FILES = 10_000
"""Files in a ``.usdz``."""


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Scene:
    """Triangles of the meshes and boxes of a stage that are visible, at the earliest time.

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
    return Scene(frame, triangles, meters_per_unit=scale, notes=answer["notes"])


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
