"""Files that a file of a world names: which of them may be read, and what to do if one may not.

They lie in the folder of that file, in the folder that ``--root`` names, or below one of them. Links count as where
they lead to.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from irsim.common.text import clean

__all__ = ["lies_in", "readable", "with_root"]


def lies_in(file: Path, folders: Iterable[Path | None]) -> bool:
    """Whether a file or a folder is one of some folders, or lies below one.

    Args:
        file: The file, which need not exist.
        folders: The folders; None stands for no folder.
    """
    target = file.resolve()
    return any(target.is_relative_to(folder.resolve()) for folder in folders if folder is not None)


def readable(file: Path, folders: Iterable[Path | None]) -> Path | None:
    """Where a file or a folder is, if it exists and lies in one of some folders; else None."""
    target = file.resolve()
    with suppress(OSError):  # such as a name that is too long
        if target.exists() and lies_in(target, folders):
            return target
    return None


def with_root(fix: str, folder: Path, file: Path) -> str:
    """Advice about a file that lies elsewhere, which begins with ``--root`` unless only a whole disk contains both.

    Args:
        fix: Another fix.
        folder: The folder of the file that names it.
        file: The file.
    """
    own, other = folder.resolve(), file.resolve().parent
    shared = next((above for above in (own, *own.parents) if other.is_relative_to(above)), None)
    if shared is None or shared == shared.parent:
        return fix
    return f"give --root {clean(str(shared), 300)} if its files there may be read, or {fix}"
