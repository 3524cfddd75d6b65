"""Shell, Python and server give the same bytes for the same scenario, seed and options.

Of the server, what is compared is the text that its tools give for ``response_format=json`` (for a benchmark,
``result.json`` of its job).
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import anyio
import pytest
from irsim_mcp.jobs import Jobs
from irsim_mcp.limits import ServerLimits
from irsim_mcp.sandbox import Workspace
from typer.testing import CliRunner

import irsim
from irsim import templates
from irsim.cli.app import app
from tests.mcp.conftest import connected, text_of

LEFT_OUT = frozenset({"run_id", "artifacts", "files"})
"""Names and files of a record."""
QUICK = ("crossing", "random-polygons", "fmcw-watch")
SEED, STEPS = 5, 40


def bytes_of(text: str) -> bytes:
    """Canonical bytes of a result without what differs from call to call."""

    def rest(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: rest(part) for key, part in value.items() if key not in LEFT_OUT}
        return [rest(part) for part in value] if isinstance(value, list) else value

    return json.dumps(rest(json.loads(text)), ensure_ascii=False, allow_nan=False).encode()


def shell(*words: object) -> bytes:
    result = CliRunner().invoke(app, [*map(str, words), "--json"])
    return bytes_of(result.stdout)


def tool(workspace: Path, name: str, **arguments: Any) -> bytes:
    async def call() -> str:
        async with connected(workspace, text=10_000_000) as client:
            result = await client.call_tool(name, {**arguments, "response_format": "json"})
        assert not result.is_error, result.content
        return text_of(result)

    return bytes_of(anyio.run(call))


def all_templates() -> list[Any]:
    return [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in templates.names()]


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in templates.names():
        shutil.copytree(templates.scenario_file(name).parent, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", all_templates())
def test_validate(workspace: Path, name: str) -> None:
    file = f"{name}/scenario.yaml"
    expected = bytes_of(irsim.validate(file).model_dump_json())
    assert shell("validate", file) == expected
    assert tool(workspace, "validate_scenario", scenario_path=file, simulate=False) == expected


@pytest.mark.parametrize("name", all_templates())
def test_run(workspace: Path, name: str) -> None:
    file = f"{name}/scenario.yaml"
    expected = bytes_of(irsim.run(file, seed=SEED, steps=STEPS, strict=True).model_dump_json())
    assert shell("run", file, "--seed", SEED, "--steps", STEPS, "--strict") == expected
    assert tool(workspace, "run_episode", scenario_path=file, seed=SEED, max_steps=STEPS) == expected


def test_run_with_another_behavior(workspace: Path) -> None:
    file, behavior = "crossing/scenario.yaml", "{name: orca, timeHorizon: 3}"
    expected = bytes_of(irsim.run(file, behavior=behavior, steps=STEPS, strict=True).model_dump_json())
    assert shell("run", file, "--behavior", behavior, "--steps", STEPS, "--strict") == expected
    assert tool(workspace, "run_episode", scenario_path=file, behavior=behavior, max_steps=STEPS) == expected


def test_who_leaves_the_world(workspace: Path) -> None:
    robot = "{kinematics: {name: diff}, shape: {name: circle}, state: [8, 5], goal: [12, 5], behavior: {name: dash}}"
    (workspace / "out.yaml").write_text(f"world: {{width: 10, height: 10}}\nrobot: {robot}\n", encoding="utf-8")
    expected = bytes_of(irsim.run("out.yaml", strict=True).model_dump_json())
    assert b"left the world at 2.1 s ('world.boundary: walls' would keep it in)" in expected
    assert shell("run", "out.yaml", "--strict") == expected
    assert tool(workspace, "run_episode", scenario_path="out.yaml") == expected


@pytest.mark.parametrize("name", ["crossing", "random-polygons"])
def test_benchmark(workspace: Path, name: str) -> None:
    file = f"{name}/scenario.yaml"
    result = irsim.benchmark([file], ["as-written", "orca"], 2, steps=STEPS, strict=True)
    expected = bytes_of(result.model_dump_json())
    told = shell(
        *("benchmark", file, "--behaviors", "as-written,orca", "--seeds", 2, "--steps", STEPS, "--strict"),
    )
    assert told == expected
    jobs = Jobs(Workspace(workspace), ServerLimits())
    arguments = {"files": [file], "behaviors": ["as-written", "orca"], "seeds": 2, "steps": STEPS}
    job = jobs.start("benchmark", arguments, 4)
    state = anyio.run(jobs.wait, job, 50.0)
    assert state["status"] == "finished"
    assert bytes_of((workspace / ".irsim" / "jobs" / job / "result.json").read_text()) == expected
