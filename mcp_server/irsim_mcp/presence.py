"""Whether the workspace is still the folder with which the server was started."""

from __future__ import annotations

import os
from contextlib import suppress

from irsim.common.text import clean
from irsim_mcp.answers import failure
from irsim_mcp.sandbox import Workspace

__all__ = ["Presence"]


class Presence:
    """The place of the workspace, whose folder stays open, so that no other one looks the same.

    Args:
        workspace: The workspace.
    """

    def __init__(self, workspace: Workspace) -> None:
        self._root, folder = workspace.root, workspace.folder
        self._known: os.stat_result | None = None
        with suppress(OSError):
            self._known = os.stat(self._root) if folder is None else os.fstat(folder.descriptor)

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
