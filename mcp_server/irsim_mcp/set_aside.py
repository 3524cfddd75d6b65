"""A folder that is written again, and that comes back if this fails."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from irsim.common.files import TEMPORARY
from irsim.runs import RunError

__all__ = ["set_aside"]


@contextmanager
def set_aside(target: Path) -> Iterator[None]:
    """Set aside the folder of an earlier export of the same run, which comes back if the new one fails."""
    if not os.path.lexists(target):
        yield
        return
    if target.is_symlink() or not target.is_dir():
        what = f"'{target}' is in the way: it is not a folder of an earlier export"
        raise RunError("file-exists", what, "remove it, or give it another name", where="to")
    aside = target.with_name(f"{TEMPORARY}{os.urandom(4).hex()}")
    target.rename(aside)
    try:
        yield
    except BaseException:
        aside.rename(target)
        raise
    shutil.rmtree(aside, ignore_errors=True)
