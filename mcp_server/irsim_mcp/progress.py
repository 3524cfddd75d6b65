"""Telling the client how far the work is: always more, at most once a second."""

from __future__ import annotations

import time
from typing import Any

from mcp.server.mcpserver import Context

from irsim_mcp.worker import Progress

__all__ = ["reporter"]

_PERIOD = 1.0


def reporter(context: Context[Any, Any], unit: str) -> Progress:
    """A function that passes progress on.

    Args:
        context: Of the call.
        unit: What is counted.
    """
    last, due = -1, 0.0

    async def report(done: int, total: int) -> None:
        nonlocal last, due
        now = time.monotonic()
        if done > last and now >= due:
            last, due = done, now + _PERIOD
            await context.report_progress(done, total, f"{done:,} of at most {total:,} {unit}")

    return report
