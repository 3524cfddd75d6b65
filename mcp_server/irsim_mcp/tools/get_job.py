"""``get_job``: wait for a job, return its progress or result, or cancel it."""

from __future__ import annotations

from typing import Annotated, Any

from mcp.server.mcpserver import Context
from mcp.types import CallToolResult
from pydantic import Field

from irsim_mcp.limits import MAX_WAIT_SECONDS
from irsim_mcp.services import Services
from irsim_mcp.tool import StrictTool, reporter, strict
from irsim_mcp.tools.benchmark import Benchmark, answer

__all__ = ["PLACE", "tool"]

PLACE = 7

_CANCEL_SECONDS = 5.0
"""Time for which the call waits for a cancelled job to end [s]."""
_DESCRIPTION = """
    Wait for a job of benchmark and return its result, or its progress. cancel=true stops it. Jobs end with the server
    and are kept for 24 hours. Next: while it is running, call again.
"""


def tool(services: Services) -> StrictTool:
    """Make the tool."""

    async def get_job(
        ctx: Context[Any, Any],
        job_id: Annotated[str, Field(description="From benchmark.")],
        wait_s: Annotated[int, Field(ge=0, le=MAX_WAIT_SECONDS)] = 45,
        cancel: bool = False,
        detailed: bool = False,
    ) -> Annotated[CallToolResult, Benchmark]:
        if cancel:
            services.jobs.cancel(job_id)
        seconds = _CANCEL_SECONDS if cancel else wait_s
        state = await services.jobs.wait(job_id, seconds, reporter(ctx, "episodes"))
        return answer(state, services.is_there, detailed)

    return strict(get_job, title="Wait for a job", description=_DESCRIPTION, read_only=False, idempotent=True)
