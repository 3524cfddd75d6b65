"""Shell, Python and server give the same bytes for the same scenario, seed and options.

The server's tools answer with a shorter structure; what is compared is what they make it of, the full answer of the
worker (for a benchmark, ``result.json`` of its job).
"""

from __future__ import annotations

import functools
import json
import shutil
from pathlib import Path
from typing import Any

import anyio
import pytest
from irsim_mcp.jobs import Jobs
from irsim_mcp.limits import ServerLimits
from irsim_mcp.sandbox import Workspace
from irsim_mcp.worker import Workers
from typer.testing import CliRunner

import irsim
from irsim import templates
from irsim.cli.app import app

LEFT_OUT = frozenset({"run_id", "artifacts", "files", "given"})
"""Names and files of a record; the value as written in findings, which a server does not repeat: it may be large."""
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


def worker(workspace: Path, task: str, **arguments: Any) -> bytes:
    workers = Workers(Workspace(workspace), ServerLimits())
    answer = anyio.run(functools.partial(workers.call, task, arguments, seconds=45))
    return bytes_of(json.dumps(answer["result"]))


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
    assert worker(workspace, "validate", path=file) == expected


@pytest.mark.parametrize("name", all_templates())
def test_run(workspace: Path, name: str) -> None:
    file = f"{name}/scenario.yaml"
    expected = bytes_of(irsim.run(file, seed=SEED, steps=STEPS, strict=True).model_dump_json())
    assert shell("run", file, "--seed", SEED, "--steps", STEPS, "--strict") == expected
    assert worker(workspace, "run", path=file, seed=SEED, steps=STEPS) == expected


def test_run_with_another_behavior(workspace: Path) -> None:
    file, behavior = "crossing/scenario.yaml", "{name: orca, timeHorizon: 3}"
    expected = bytes_of(irsim.run(file, behavior=behavior, steps=STEPS, strict=True).model_dump_json())
    assert shell("run", file, "--behavior", behavior, "--steps", STEPS, "--strict") == expected
    assert worker(workspace, "run", path=file, behavior=behavior, steps=STEPS) == expected


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
