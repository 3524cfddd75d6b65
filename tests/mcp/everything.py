"""Calls every tool, resource, prompt and completion of a server in this process, and prints what that has loaded.

Run by itself, ``python -m tests.mcp.everything FOLDER``: a process that runs tests has loaded much already.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import anyio
from mcp import Client
from mcp.types import PromptReference, ResourceTemplateReference

from irsim_mcp.server import build_server

HEAVY = ("numpy", "shapely", "matplotlib", "PIL", "irsim._core", "irsim.env", "irsim.behaviors", "irsim.simulation")
ROOM = """\
world: {width: 8, height: 6}
robot:
  - {name: rover, kinematics: {name: diff}, state: [1, 1, 0], goal: [3, 2, 0], behavior: {name: dash}}
"""


async def called(workspace: Path) -> set[str]:
    """Do everything; the names of the tools that were called."""
    long = "{name: orca, timeHorizon: 5, loop: false}"
    async with Client(build_server(workspace, writing=True), raise_exceptions=True) as client:

        async def call(name: str, **arguments: Any) -> dict[str, Any]:
            result = await client.call_tool(name, arguments)
            assert not result.is_error, result.content
            names.add(name)
            return result.structured_content or {}

        names = set[str]()
        for topic in ("", "laser", "robot.sensors.lidar2d", "crossing", "unknown-key", "spl"):
            await call("lookup", topic=topic)
        await call("lookup", topic="crossing", parameters={"beams": 90})
        assert (await client.call_tool("lookup", {"topic": "xyzzy"})).is_error
        await call("write_scenario", path="room.yaml", yaml=ROOM)
        await call("validate_scenario", scenario_path="room.yaml", base=ROOM)
        await call("render_snapshot", scenario_path="room.yaml", size_px=200)
        run = await call("run_episode", scenario_path="room.yaml")
        await call("inspect_run", run_id=run["run_id"], view="closest")
        await call("export_run", run_id=run["run_id"], to="csv")
        job = await call("benchmark", scenarios=["room.yaml", ROOM], behaviors=["dash", long], seeds=2)
        await call("get_job", job_id=job["job_id"])
        await call("inspect_run", run_id=job["job_id"])
        for resource in (await client.list_resources()).resources:
            await client.read_resource(str(resource.uri))
        await client.read_resource("irsim://schema/robot.sensors.lidar2d")
        for artifact in ("run.json", "events.json", "trace.csv", "replay.json"):
            await client.read_resource(f"irsim://runs/{run['run_id']}/{artifact}")
        given = {"goal": "a", "run_id": run["run_id"], "scenario": "room.yaml"}
        for prompt in (await client.list_prompts()).prompts:
            taken = {item.name: given[item.name] for item in prompt.arguments or () if item.required}
            await client.get_prompt(prompt.name, taken)
            for item in prompt.arguments or ():
                reference = PromptReference(type="ref/prompt", name=prompt.name)
                await client.complete(reference, {"name": item.name, "value": ""})
        for template in (await client.list_resource_templates()).resource_templates:
            uri = ResourceTemplateReference(type="ref/resource", uri=template.uri_template)
            for argument in ("section", "name", "topic", "run_id", "artifact"):
                await client.complete(uri, {"name": argument, "value": ""})
        assert names == {tool.name for tool in (await client.list_tools()).tools}
    return names


def mapped() -> list[str]:
    """Files of the engine and of NumPy in the memory of this process."""
    maps = Path("/proc/self/maps")
    lines = maps.read_text().splitlines() if maps.exists() else []
    return sorted({line.split()[-1] for line in lines if "/_core." in line or "/numpy" in line})


if __name__ == "__main__":
    anyio.run(called, Path(sys.argv[1]))
    print(json.dumps([name for name in HEAVY if name in sys.modules] + mapped()))
