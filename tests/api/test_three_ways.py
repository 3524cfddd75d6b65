"""Shell, Python and server give the same bytes for the same scenario, seed and options.

Of the server, what is compared is the text that its tools give for ``response_format=json`` (for a benchmark,
``result.json`` of its job).
"""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

import anyio
import pytest
from typer.testing import CliRunner

import irsim
from irsim.bundled import templates
from irsim.cli.app import app
from irsim_mcp.jobs import Jobs
from irsim_mcp.limits import ServerLimits
from irsim_mcp.sandbox import Workspace
from tests.effort import some
from tests.mcp.conftest import connected, text_of

pytestmark = pytest.mark.one_python

LEFT_OUT = re.compile(rb'("run_id":)(?:"[^"]*"|null)|("artifacts":)\{[^}]*\}|("files":)\[[^]]*\]')
"""Names and files of a record."""
SEED, STEPS = 5, 40


def bytes_of(text: str) -> bytes:
    """The bytes as they came, but for what differs from call to call."""
    return LEFT_OUT.sub(rb"\1\2\3", text.encode())


def shell(*words: object) -> bytes:
    result = CliRunner().invoke(app, [*map(str, words), "--json"])
    assert result.stdout.endswith("}\n")
    return bytes_of(result.stdout[:-1])


def tool(workspace: Path, name: str, **arguments: Any) -> bytes:
    async def call() -> str:
        async with connected(workspace, text=10_000_000) as client:
            result = await client.call_tool(name, {**arguments, "response_format": "json"})
        assert not result.is_error, result.content
        return text_of(result)

    return bytes_of(anyio.run(call))


@pytest.fixture
def name() -> str:
    return "crossing"


@pytest.fixture
def workspace(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current directory, with the template that the test is about."""
    shutil.copytree(templates.scenario_file(name).parent, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", some(templates.names(), 15))
def test_validate(workspace: Path, name: str) -> None:
    file = f"{name}/scenario.yaml"
    expected = bytes_of(irsim.validate(file).model_dump_json())
    assert shell("validate", file) == expected
    assert tool(workspace, "validate_scenario", scenario_path=file, simulate=False) == expected


def test_validate_with_findings_and_odd_characters(workspace: Path) -> None:
    text = (workspace / "crossing/scenario.yaml").read_text(encoding="utf-8")
    odd = text.replace("behavior:", "behaviour:").replace("goal:", "gaol:") + "caf\u00e9\u4e2d\U0001f600: 1.0e-7\n"
    (workspace / "odd.yaml").write_text(odd + 'x: "\\u202e\\u009b\\U000e0001\\x7f"\n', encoding="utf-8")
    result = irsim.validate("odd.yaml")
    assert len(result.findings) > 3
    expected = bytes_of(result.model_dump_json())
    assert b"caf\xc3\xa9" in expected
    assert b"\xe2\x80\xae" not in expected
    assert json.loads(expected)["findings"] == result.model_dump(mode="json")["findings"]
    assert shell("validate", "odd.yaml") == expected
    assert tool(workspace, "validate_scenario", scenario_path="odd.yaml") == expected


def test_json_is_indented_for_people_only(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = "crossing/scenario.yaml"
    monkeypatch.setattr("irsim.cli.output.is_terminal", lambda *, stderr=False: True)
    shown = CliRunner().invoke(app, ["run", file, "--steps", "3", "--json"]).stdout
    assert shown.startswith('{\n  "scenario": ')
    assert len(CliRunner().invoke(app, ["validate", file, "--json"]).stdout.splitlines()) == 1


@pytest.mark.parametrize("name", some(templates.names(), 15))
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
    told = shell(*("benchmark", file, "--behaviors", "as-written,orca", "--seeds", 2, "--steps", STEPS, "--strict"))
    assert told == expected
    jobs = Jobs(Workspace(workspace), ServerLimits())
    arguments = {"files": [file], "behaviors": ["as-written", "orca"], "seeds": 2, "steps": STEPS}
    job = jobs.start("benchmark", arguments, 4)
    state = anyio.run(jobs.wait, job, 50.0)
    assert state["status"] == "finished"
    assert bytes_of((workspace / ".irsim" / "jobs" / job / "result.json").read_text()) == expected
