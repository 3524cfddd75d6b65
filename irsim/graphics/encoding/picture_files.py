"""Paths of picture files, and writing them so that no incomplete file is ever left behind."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["PICTURE_FORMATS", "picture_path", "replacing"]

PICTURE_FORMATS = ("png", "jpg", "jpeg", "webp", "tif", "tiff", "svg", "svgz", "pdf", "eps", "ps")
"""File formats of figures."""


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
        raise ValueError(f"cannot save a figure as {suffix!r}: choose one of {', '.join(PICTURE_FORMATS)}")
    index = "" if count is None else f"_{count:04d}"
    return Path(folder) / f"{stem}{index}.{suffix}"


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary file beside ``path``, which replaces it if the block succeeds and is deleted otherwise.

    The folder is made if it does not exist.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.stem}.{os.getpid()}-{id(path):x}{path.suffix}")
    try:
        yield temporary
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
