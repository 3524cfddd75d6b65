"""Every tool called by other clients: ``clients.py NAME PYTHON WORKSPACE``, in the environment of that client."""

from __future__ import annotations

import asyncio
import re
import sys

ROOM = """\
world: {width: 8, height: 6}
robot:
  - {kinematics: {name: diff}, state: [1, 1, 0], goal: [4, 3, 0], behavior: {name: dash}}
"""
FIRST = (
    ("lookup", {"topic": "dash"}),
    ("validate_scenario", {"scenario_yaml": ROOM}),
    ("render_snapshot", {"scenario_yaml": ROOM, "size_px": 200}),
    ("run_episode", {"scenario_yaml": ROOM, "seed": 1}),
    ("benchmark", {"scenarios": [ROOM], "behaviors": ["dash"], "seeds": 2, "wait_s": 40}),
)


def after(run_id: str, job_id: str) -> tuple[tuple[str, dict[str, object]], ...]:
    """Calls that need what others have made."""
    return (
        ("inspect_run", {"run_id": run_id}),
        ("export_run", {"run_id": run_id, "to": "csv"}),
        ("get_job", {"job_id": job_id, "wait_s": 1}),
        ("write_scenario", {"path": "room.yaml", "yaml": ROOM, "overwrite": True}),
    )


async def anthropic(python: str, arguments: list[str]) -> tuple[set[str], set[str]]:
    """``async_mcp_tool`` of the Anthropic SDK, as its tool runner calls it: names of the tools that it has called, and
    of all tools."""
    from anthropic.lib.tools.mcp import async_mcp_tool
    from mcp import Client, StdioServerParameters

    async with Client(StdioServerParameters(command=python, args=arguments)) as client:
        tools = {tool.name: async_mcp_tool(tool, client) for tool in (await client.list_tools()).tools}
        told = {name: str(await tools[name].call(call)) for name, call in FIRST}
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
        return set(told), set(tools)


async def mcp1(python: str, arguments: list[str]) -> tuple[set[str], set[str]]:
    """The SDK before version 2 (``mcp<2``), with a resource and a prompt."""
    from mcp import ClientSession, StdioServerParameters
    from mcp.client.stdio import stdio_client

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
        assert (await session.read_resource("irsim://docs/readme")).contents
        assert (await session.get_prompt("design_scenario", {"goal": "two robots"})).messages
        return set(made), set(names)


def main(client: str, python: str, workspace: str) -> None:
    arguments = ["-m", "irsim_mcp", "--workspace", workspace, "--enable-write"]
    called, known = asyncio.run({"anthropic": anthropic, "mcp1": mcp1}[client](python, arguments))
    assert called == known, called ^ known
    print(f"{len(called)} tools")


main(*sys.argv[1:])
