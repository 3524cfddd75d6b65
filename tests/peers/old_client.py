"""A client of the SDK before version 2 (``mcp<2``): every tool, a resource, a prompt, a completion. Own environment."""

from __future__ import annotations

import asyncio
import sys

from calls import FIRST, after
from mcp import ClientSession, StdioServerParameters
from mcp.client.stdio import stdio_client


async def main(python: str, workspace: str) -> None:
    arguments = ["-m", "irsim_mcp", "--workspace", workspace, "--enable-write"]
    server = StdioServerParameters(command=python, args=arguments)
    async with stdio_client(server) as (read, write), ClientSession(read, write) as session:
        await session.initialize()
        names = [tool.name for tool in (await session.list_tools()).tools]
        made = {}
        for name, call in FIRST:
            result = await session.call_tool(name, call)
            assert not result.isError, (name, result)
            made[name] = result.structuredContent or {}
        job = made["benchmark"].get("job_id") or "none"
        for name, call in after(made["run_episode"]["run_id"], job):
            result = await session.call_tool(name, call)
            assert not result.isError or (name == "get_job" and job == "none"), (name, result)
            made[name] = {}
        assert set(made) == set(names), set(names) ^ set(made)
        assert (await session.read_resource("irsim://docs/readme")).contents
        assert (await session.get_prompt("design_scenario", {"goal": "two robots"})).messages
    print(f"{len(made)} tools")


asyncio.run(main(*sys.argv[1:]))
