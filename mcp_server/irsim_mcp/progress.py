"""Progress notifications for the client: always increasing, at most one per second."""

from __future__ import annotations

import time
from typing import Any

from mcp.server.mcpserver import Context

from irsim_mcp.worker import Progress

__all__ = ["reporter"]

_PERIOD_S = 1.0
"""Least time between two notifications [s]."""


def reporter(context: Context[Any, Any], unit: str) -> Progress:
    """A callback that reports progress to the client.

    Args:
        context: Context of the call.
        unit: Unit of the counted work, such as ``steps``.
    """
    last, due = -1, 0.0

    async def report(done: int, total: int) -> None:
        nonlocal last, due
        now = time.monotonic()
        if done > last and now >= due:
            last, due = done, now + _PERIOD_S
            await context.report_progress(done, total, f"{done:,} of at most {total:,} {unit}")

    return report
