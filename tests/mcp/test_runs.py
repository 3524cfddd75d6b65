"""Recorded runs through the server: inspect_run, pictures, resources, the replay page, what a restart finds."""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path
from typing import Any

import anyio
import pytest
from mcp import Client
from mcp.server.apps import APP_MIME_TYPE, EXTENSION_ID
from mcp.shared.exceptions import MCPError

from irsim.runs import list_runs, open_run
from irsim.runs.inspection import inspect_run
from irsim.runs.replay.page import page
from irsim.runs.store import ARTIFACTS
from irsim_mcp.resources import PAGE
from tests.mcp.conftest import (
    CRASH,
    ERAS,
    LONG,
    ROOM,
    Caller,
    as_process,
    connected,
    data_of,
    error_of,
    image_of,
    text_of,
)
from tests.runs.replay.reading import unpacked

pytestmark = [pytest.mark.one_python, pytest.mark.anyio]


async def crashed(client: Client, **arguments: Any) -> str:
    """Run a crash; its run id."""
    return str((await client.data("run_episode", scenario_yaml=CRASH, seed=3, **arguments))["run_id"])


@pytest.mark.parametrize("era", ERAS)
async def test_an_episode_is_recorded(client: Caller, workspace: Path) -> None:
    result = await client.call("run_episode", scenario_yaml=CRASH, seed=3)
    data, text = data_of(result), text_of(result)
    run = open_run(data["run_id"], workspace)
    assert run.status == "finished"
    assert f"Run: {run.id}" in text
    assert f"run_id={run.id}" in data["next"]
    assert all(uri in text for uri in data["artifacts"].values())
    assert list((workspace / ".irsim").rglob(".new-*")) == []
    assert sorted(path.name for path in workspace.iterdir()) == [".irsim"]


async def test_inspect_run_is_the_same_as_python(client: Caller, workspace: Path) -> None:
    run_id = await crashed(client)
    for view in ("rows", "collisions", "closest", "speeds"):
        result = await client.call("inspect_run", run_id=run_id, view=view)
        data, text = data_of(result), text_of(result)
        table = inspect_run(run_id, view=view, workspace=workspace)
        same = {key: value for key, value in data.items() if key != "next"}
        assert same == json.loads(table.model_dump_json())  # which is what `irsim inspect --json` prints
        assert all(str(cell) in text for row in data["rows"] for cell in row if cell is not None)
    hit = await client.data("inspect_run", run_id=run_id, view="collisions")
    assert [hit["rows"][0][n] for n in (2, 3)] == ["rover", "crate"]
    assert f"step={hit['rows'][0][0]}" in hit["next"]


async def test_pages(client: Caller, workspace: Path) -> None:
    run_id = await crashed(client)
    first = await client.data("inspect_run", run_id=run_id, every=1, limit=5)
    assert f"cursor={first['next_cursor']}" in first["next"]
    second = await client.data("inspect_run", run_id=run_id, every=1, limit=5, cursor=first["next_cursor"])
    assert [row[0] for row in first["rows"] + second["rows"]] == list(range(10))


async def test_long_tables_are_cut_to_what_a_model_reads(workspace: Path) -> None:
    fields = ["x", "y", "heading", "speed", "turn_rate", "control", "goal", "goal_distance", "nearest_hit", "status"]
    many = CRASH.replace("- name: rover", f"- name: {'r' * 60}")
    async with connected(workspace, text=5000) as client:
        result = await client.call("run_episode", scenario_yaml=many, seed=3)
        ask = {"run_id": data_of(result)["run_id"], "every": 1, "limit": 200, "fields": fields}
        steps: list[int] = []
        while True:
            result = await client.call_tool("inspect_run", ask)
            data = data_of(result)
            assert len(text_of(result)) <= 5000
            assert len(json.dumps(data)) <= 5000
            steps += [row[0] for row in data["rows"]]
            if data["next_cursor"] is None:
                break
            ask["cursor"] = data["next_cursor"]
    assert steps == list(range(open_run(str(ask["run_id"]), workspace).last_step + 1))


async def test_tables_have_what_sensors_report(client: Caller, workspace: Path) -> None:
    sensing = CRASH.replace(
        "- name: rover", "- name: rover\n    sensors: [{name: odometry}, {name: imu, gyro_noise: 0.1}]"
    )
    run_id = (await client.data("run_episode", scenario_yaml=sensing, seed=3))["run_id"]
    data = await client.data("inspect_run", run_id=run_id, fields=["x", "readings"], every=1, limit=3)
    assert data["columns"][3:6] == ["x", "odometry.x", "odometry.y"]
    assert data["columns"][-3:] == ["imu.yaw_rate", "imu.ax", "imu.ay"]
    readings = open_run(run_id, workspace).trace().readings
    assert data["rows"][2][-3] == pytest.approx(readings["rover/imu"]["yaw_rate"][2], abs=1e-4)


async def test_unknown_runs_name_recent_ones(client: Caller, workspace: Path) -> None:
    assert "there are no runs here; runs are deleted 24 h after" in await client.error("inspect_run", run_id="x")
    run_id = await crashed(client)
    for wrong in ("crash-000000", "../..", "", "\x00", "a" * 100, f"{run_id}/../{run_id}"):
        for tool in ("inspect_run", "render_snapshot"):
            error = await client.error(tool, run_id=wrong)
            assert error.startswith("unknown-run: ")
            assert run_id in error
    error = await client.error("inspect_run", run_id=run_id, from_step=4000)
    assert error.startswith("step-out-of-range: ")
    assert "(from_step)" in error
    error = await client.error("inspect_run", run_id=run_id, robot="rovr")
    assert "(robot). Fix: did you mean 'rover'?" in error
    error = await client.error("inspect_run", run_id=run_id, cursor="x")
    assert "(cursor)" in error


async def test_a_picture_of_a_run_is_that_of_the_scenario(client: Caller, workspace: Path) -> None:
    run_id = await crashed(client)
    of_run = await client.call("render_snapshot", run_id=run_id, step=20)
    scenario = {"scenario_yaml": CRASH, "seed": 3, "step": 20}
    of_scenario = await client.call_tool("render_snapshot", scenario)
    assert image_of(of_run).data == image_of(of_scenario).data
    assert f"irsim://runs/{run_id}/run.json" in text_of(of_run)
    assert f"step {open_run(run_id, workspace).last_step}," in await client.text(
        "render_snapshot", run_id=run_id, step=-1, return_image=False
    )
    beyond = await client.call("render_snapshot", run_id=run_id, step=4000)
    assert error_of(beyond).startswith("step-out-of-range: ")
    strip = await client.call("render_snapshot", run_id=run_id, step=20, strip=3)
    assert image_of(strip).data == (await client.image("render_snapshot", **scenario, strip=3)).data
    assert "steps 0, 10, 20, the last: t=2 s (step 20" in text_of(strip)
    assert f"steps 0, {open_run(run_id, workspace).last_step}, the last:" in await client.text(
        "render_snapshot", run_id=run_id, strip=2, return_image=False
    )
    beyond = await client.call("render_snapshot", run_id=run_id, step=4000, strip=3)
    assert error_of(beyond).startswith("step-out-of-range: ")
    assert (await client.error("render_snapshot", run_id=run_id, seed=1)).startswith("bad-argument: ")


@pytest.mark.parametrize("era", ERAS)
async def test_runs_are_resources(client: Caller, workspace: Path) -> None:
    run_id = await crashed(client)
    templates = (await client.list_resource_templates()).resource_templates
    assert any(item.uri_template.startswith("irsim://runs/{run_id}/{artifact}") for item in templates)
    for name in ARTIFACTS:
        assert await read(client, f"irsim://runs/{run_id}/{name}")
    assert await read(client, f"irsim://runs/{run_id}/scenario.yaml") == CRASH
    assert [item.mime_type for item in templates if "/runs/" in item.uri_template] == [None]
    types = {"json": "application/json", "csv": "text/csv", "yaml": "application/yaml"}
    for name in ARTIFACTS:
        (content,) = (await client.read_resource(f"irsim://runs/{run_id}/{name}")).contents
        assert content.mime_type == types[name.rpartition(".")[2]]
    (content,) = (await client.read_resource(f"irsim://runs/{run_id}/result.json?offset=9")).contents
    assert content.mime_type == "text/plain"  # no JSON by itself
    part = json.loads(await read(client, f"irsim://runs/{run_id}/trace.json?from_step=3&to_step=9&every=2"))
    assert [row["step"] for row in part["rows"]] == [3, 5, 7, 9]
    for wrong in (f"{run_id}/secret", "unknown-123456/run.json", f"{run_id}/..%2Frun.json"):
        with pytest.raises(MCPError):
            await read(client, f"irsim://runs/{wrong}")
    for wrong in ("from_step=x", "every=0", "offset=-1", "to_step=1.5", "from_step=" + "9" * 40):
        with pytest.raises(MCPError, match=f"bad-argument: {wrong.partition('=')[0]} must be a whole number"):
            await read(client, f"irsim://runs/{run_id}/trace.csv?{wrong}")


async def read(client: Client, uri: str) -> str:
    (content,) = (await client.read_resource(uri)).contents
    return str(getattr(content, "text", ""))


@pytest.mark.usefixtures("ordinary_processes")
async def test_a_cancelled_run_says_so_and_can_be_read(client: Caller, workspace: Path) -> None:
    async with anyio.create_task_group() as tasks:

        async def cancel(done: float, total: float | None, message: str | None) -> None:
            if list(workspace.rglob("trace*")):  # some of it is written down
                tasks.cancel_scope.cancel()

        await client.call_tool("run_episode", {"scenario_yaml": LONG, "seed": 1}, progress_callback=cancel)
    with anyio.fail_after(20):
        while not (runs := list_runs(workspace)) or runs[0].status == "running":
            await anyio.sleep(0.1)
    assert runs[0].status == "cancelled"
    result = await client.call("inspect_run", run_id=runs[0].id, limit=3)
    assert data_of(result)["status"] == "cancelled"
    assert text_of(result).startswith("cancelled: ")


@pytest.mark.slow
@pytest.mark.usefixtures("ordinary_processes")
async def test_a_run_whose_time_is_over_is_named(client: Caller, workspace: Path) -> None:
    error = await client.error("run_episode", scenario_yaml=LONG, seed=1, max_wall_s=4)
    (run,) = list_runs(workspace)
    assert error.startswith("out-of-time: ")
    assert f"inspect_run run_id={run.id}" in error
    assert run.status == "interrupted"
    assert len(run.trace()) > 0


async def test_runs_survive_a_restart(workspace: Path) -> None:
    async with Caller(as_process(workspace)) as client:
        run_id = await crashed(client)
    async with Caller(as_process(workspace)) as client:
        assert (await client.data("inspect_run", run_id=run_id, view="speeds"))["rows"][0][0] == "rover"


async def test_links_out_of_the_workspace_are_not_followed(client: Caller, workspace: Path, tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    (workspace / ".irsim").symlink_to(outside, target_is_directory=True)
    error = await client.error("run_episode", scenario_yaml=ROOM)
    assert error.startswith("path-outside-workspace: ")
    assert (await client.error("inspect_run", run_id="x")).startswith("path-outside-workspace: ")
    assert list(outside.iterdir()) == []


async def test_what_cannot_be_recorded_runs_all_the_same(workspace: Path) -> None:
    async with connected(workspace, written=1000) as client:
        result = await client.call("run_episode", scenario_yaml=CRASH, seed=3)
    data = data_of(result)
    assert data["outcome"] == "collision"
    assert "run_id" not in data
    assert re.search(r"render_snapshot scenario_path=\S+ strip=6 step=", data["next"])
    assert "Record: none" in text_of(result)


@pytest.mark.parametrize("era", ERAS)
async def test_run_episode_points_at_the_page(client: Caller, era: str) -> None:
    tools = (await client.list_tools()).tools
    listed = (await client.list_resources()).resources
    (content,) = (await client.read_resource(PAGE)).contents
    extensions = client.server_capabilities.extensions if client.server_capabilities else None
    pages = {tool.name: tool.meta for tool in tools if tool.meta}
    assert pages == {"run_episode": {"ui": {"resourceUri": PAGE}}}
    assert [str(item.uri) for item in listed if item.mime_type == APP_MIME_TYPE] == [PAGE]
    assert content.mime_type == APP_MIME_TYPE
    assert content.text == page()
    assert len(content.text.encode()) <= 3_000_000
    assert content.meta == {"ui": {"prefersBorder": True}}
    if era != "legacy":
        assert EXTENSION_ID in (extensions or {})


async def test_the_page_can_read_a_run(client: Caller, workspace: Path) -> None:
    (workspace / "matplotlibrc").write_text("lines.linewidth: nonsense\n")
    run_id = (await client.data("run_episode", scenario_yaml=CRASH, seed=3))["run_id"]
    (content,) = (await client.read_resource(f"irsim://runs/{run_id}/replay.json?offset=0")).contents
    part = json.loads(content.text)
    assert len(part["data"]) == part["total"]
    head, columns = unpacked(base64.b64decode(part["data"]))
    assert columns["step"].tolist() == open_run(run_id, workspace).trace().step.tolist()
    assert head["outcome"] == "collision"
