"""Paths of picture files."""

from __future__ import annotations

import os
from pathlib import Path

from irsim.diagnostics.errors import InputError

__all__ = ["MOVING_SUFFIXES", "PICTURE_FORMATS", "VIDEO_SUFFIXES", "picture_path"]

PICTURE_FORMATS = ("png", "jpg", "jpeg", "webp", "tif", "tiff", "svg", "svgz", "pdf", "eps", "ps")
"""File formats of figures."""
VIDEO_SUFFIXES = (".mp4", ".m4v", ".mov", ".mkv", ".webm", ".avi")
"""Suffixes of files that a video encoder writes."""
MOVING_SUFFIXES = (".gif", ".apng", *VIDEO_SUFFIXES)
"""Suffixes that always mean an animation."""


def picture_path(
    folder: str | Path,
    name: str | Path | None,
    default: str,
    *,
    count: int | None = None,
    format: str | None = None,
    default_format: str | None = None,
) -> Path:
    """Return the path of the file that a figure is saved to.

    Args:
        folder: Folder of names that are not absolute.
        name: File name with or without suffix; None stands for ``default``.
        default: Default file name, such as the name of the world.
        count: Step number to append as ``_0042``.
        format: File format; it replaces the suffix of the name.
        default_format: Format of names without suffix (default png).

    Raises:
        ValueError: The format is not supported.
    """
    given = str(name) if name is not None and str(name) else default
    stem, dot, suffix = given.rpartition(".")
    if not dot or "/" in suffix or os.sep in suffix or not stem or name is None:
        stem, suffix = given, default_format or "png"
    suffix = (format or suffix).lower().lstrip(".")
    if suffix not in PICTURE_FORMATS:
        raise InputError(f"cannot save a figure as {suffix!r}", f"choose one of {', '.join(PICTURE_FORMATS)}")
    index = "" if count is None else f"_{count:04d}"
    return Path(folder) / f"{stem}{index}.{suffix}"
