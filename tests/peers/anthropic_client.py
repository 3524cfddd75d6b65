"""Every tool through ``async_mcp_tool`` of the Anthropic SDK, as its tool runner calls it. Own environment."""

from __future__ import annotations

import asyncio
import re
import sys

from anthropic.lib.tools.mcp import async_mcp_tool
from calls import FIRST, after
from mcp import Client, StdioServerParameters


async def main(python: str, workspace: str) -> None:
    arguments = ["-m", "irsim_mcp", "--workspace", workspace, "--enable-write"]
    async with Client(StdioServerParameters(command=python, args=arguments)) as client:
        tools = {tool.name: async_mcp_tool(tool, client) for tool in (await client.list_tools()).tools}
        told = {}
        for name, call in FIRST:
            told[name] = str(await tools[name].call(call))
        run = re.search(r"run_id[=: ']+([\w-]+)|\b(scenario-[0-9a-f]{6})\b", told["run_episode"])
        job = re.search(r"benchmark-[0-9a-f]{6}", told["benchmark"])
        assert run, told["run_episode"]
        for name, call in after(run[1] or run[2], job[0] if job else "none"):
            try:
                told[name] = str(await tools[name].call(call))
            except Exception:
                if name != "get_job" or job:
                    raise
                told[name] = ""
        assert set(told) == set(tools), set(tools) ^ set(told)
    print(f"{len(told)} tools")


asyncio.run(main(*sys.argv[1:]))
