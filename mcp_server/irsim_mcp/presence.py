"""Whether the workspace is still the folder with which the server was started."""

from __future__ import annotations

import os
import weakref
from contextlib import suppress
from pathlib import Path

from irsim.common.text import clean
from irsim_mcp.answers import failure

__all__ = ["Presence"]


class Presence:
    """The place of a folder, which is open as long as this object lives, so that no other one looks the same.

    Args:
        root: The folder.
    """

    def __init__(self, root: Path) -> None:
        self._root = root
        self._known: os.stat_result | None = None
        with suppress(OSError):
            if os.name == "posix":
                descriptor = os.open(root, os.O_RDONLY)
                weakref.finalize(self, os.close, descriptor).atexit = False
            self._known = os.stat(root)

    def check(self) -> None:
        """Check that the folder is there.

        Raises:
            ToolError: It was deleted, renamed or replaced.
        """
        try:
            now = os.lstat(self._root)
        except OSError as error:
            why = f"is not there any more ({error.strerror or error})"
        else:
            if self._known is None or os.path.samestat(self._known, now):
                return
            why = "was replaced by something else"
        fix = "put the folder back where it was, or start the server again"
        raise failure("workspace-gone", f"the workspace {clean(self._root, 200)} {why}", fix=fix)
