"""Errors of a worker as data, which :func:`irsim_mcp.services.as_failure` puts into one line."""

from __future__ import annotations

import os
import traceback
from contextlib import suppress
from typing import Any

from irsim.common.held import current
from irsim.common.text import clean

__all__ = ["error_data"]

_MAX_FINDINGS = 3
"""Number of errors of a scenario that an answer lists."""


def error_data(error: Exception) -> dict[str, Any]:
    """An exception as data: its code, words, place and fix."""
    from irsim.diagnostics.diagnostic import format_path
    from irsim.diagnostics.errors import IrsimError, PlacementError, ScenarioError, ScenarioNotFoundError, said_by_core

    if isinstance(error, PlacementError):
        first = error.diagnostics[0]
        return {"code": first.code, "what": first.message, "where": format_path(first.path), "fix": first.fix}
    if isinstance(error, ScenarioError):
        errors = [item for item in error.diagnostics if item.severity == "error"]
        own = ("code", "line", "file", "fix")
        named = [
            {"what": one.message, "where": format_path(one.path), **{key: getattr(one, key) for key in own}}
            for one in errors[:_MAX_FINDINGS]
        ]
        return {"code": "invalid-scenario", "errors": len(errors), "first": named}
    if isinstance(error, ScenarioNotFoundError):
        return {"code": "file-not-found", "what": "the scenario file no longer exists"}
    if isinstance(error, IrsimError):
        return {"code": error.code, "what": error.message or str(error), "fix": error.fix, "where": error.where}
    if isinstance(error, MemoryError):
        what = said_by_core(error) or "the work needs more memory than a worker may use"
        return {"code": "out-of-memory", "what": what, "fix": "use fewer objects, lidar beams or steps"}
    if isinstance(error, OSError) and (name := _own_file(error)) is not None:
        what = f"{clean(name)!r} cannot be read or written: {error.strerror or error}"
        return {"code": "file-access", "what": what, "fix": "call again: another program seems to change the workspace"}
    traceback.print_exception(error)
    frame = traceback.extract_tb(error.__traceback__)[-1]
    place = f"{os.path.basename(frame.filename)}:{frame.lineno}"
    return {
        "code": "internal-error",
        "what": f"{type(error).__name__}: {error} at {place}",
        "fix": "none in the scenario: this is a fault of the simulator; please report it with the scenario",
    }


def _own_file(error: OSError) -> str | None:
    """The file of the workspace that an error of the system is about; None for other files."""
    folder = current()
    with suppress(OSError, TypeError):
        return None if folder is None or error.filename is None else folder.below(error.filename)
    return None
