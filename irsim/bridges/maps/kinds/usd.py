"""``usd``: stages of OpenUSD, read in a process of its own.

The library is C++ that trusts its files: a damaged one may end the process, and a stage can pull in any other file. The
process has limits of memory and time, and :mod:`irsim.bridges.maps.kinds._usd_process` looks at the references of the
layers before it opens the stage.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from irsim.bridges.maps.source import ImportLimits, ImportOptions, Kind, Scene, unusable
from irsim.common.archives import opened_archive
from irsim.common.child import ONE_THREAD
from irsim.common.records import ContentError

__all__ = ["KIND"]

_MAX_FILES = 10_000
"""Files in a ``.usdz``."""
_ONE_THREAD = ONE_THREAD | {"PXR_WORK_THREAD_LIMIT": "1", "MALLOC_ARENA_MAX": "2"}
"""Environment of the process: each thread reserves address space, of which the process may have a limited amount."""


def read(path: Path, options: ImportOptions, limits: ImportLimits) -> Scene:
    """Triangles of the meshes and boxes of a stage that are visible, at the earliest time.

    Raises:
        BridgeError: The stage is damaged, refers to places outside of its folder, or has no meshes.
    """
    if options.up == "-y":
        raise unusable(path, "y does not point down in stages of USD", "give --up y or z, or leave it out")
    if path.suffix.lower() == ".usdz":
        _check_archive(path)
    with tempfile.TemporaryDirectory(prefix="irsim-usd-") as folder:
        out = Path(folder) / "stage.npz"
        request = {"file": os.path.abspath(path), "out": str(out), "triangles": limits.triangles}
        request |= {"up": options.up, "unit": options.meters_per_unit}
        command = [sys.executable, "-m", "irsim.bridges.maps.kinds._usd_process"]
        try:
            done = subprocess.run(
                command,
                input=json.dumps(request),
                capture_output=True,
                text=True,
                timeout=limits.seconds,
                check=False,
                cwd=folder,  # from which Python would import modules
                env=os.environ | _ONE_THREAD,
            )
        except subprocess.TimeoutExpired:
            what = f"reading it took longer than {limits.seconds:g} s"
            raise unusable(path, what, "give a smaller stage, such as one without instances") from None
        answer = _answer(done.stdout)
        if "error" in answer:
            raise unusable(path, answer["error"], answer.get("fix"))
        if done.returncode != 0 or not out.is_file():
            lines = [line.strip() for line in done.stderr.splitlines() if line.strip() and not line.startswith("#")]
            said = f"; {lines[-1][:200]}" if lines else ""
            raise unusable(path, f"the library for USD failed on it (exit code {done.returncode}{said})")
        with np.load(out, allow_pickle=False) as stored:
            triangles = stored["triangles"]
    scale, frame = float(answer["meters_per_unit"]), answer["frame"]
    if not np.isfinite(triangles).all():
        raise unusable(path, "some of its points are not numbers")
    if not len(triangles):
        raise unusable(path, "it has no visible meshes", "export the stage with its meshes, not only references")
    return Scene(frame, triangles, meters_per_unit=scale, notes=answer["notes"])


def _answer(text: str) -> dict[str, Any]:
    """The answer of the process: its last line of JSON."""
    lines = [line for line in text.splitlines() if line.startswith("{")]
    result = json.loads(lines[-1]) if lines else {}
    return result if isinstance(result, dict) else {}


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
    unused=("opacity", "lanes", "root"),
)
