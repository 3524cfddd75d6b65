"""Every command that simulates without the bridges of a scenario says so, in one line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import irsim
from irsim import api
from irsim.benchmarks import logged
from irsim.cli.app import app
from irsim.validation.file_reports import task_report

SCENE = """
world: {width: 10, height: 10}
robot:
  {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0], goal: [3, 1], behavior: {name: dash}}
"""
BRIDGES = "bridges: [{name: json_lines}, {name: mujoco}, {name: json_lines, address: '127.0.0.1:9100'}]\n"
TASK = """
{task: mine, version: 1, title: One robot, file: scene.yaml, observation: [{name: goal}], reward: [{name: arrival}]}
"""
SAID = "simulates without the bridges of the scenario (json_lines, mujoco)"


@pytest.fixture(autouse=True)
def scene() -> Path:
    Path("plain.yaml").write_text(SCENE)
    Path("scene.yaml").write_text(SCENE + BRIDGES)
    return Path("scene.yaml")


def call(*words: str):
    return CliRunner().invoke(app, words)


def test_a_benchmark() -> None:
    result = irsim.benchmark(["plain.yaml", "scene.yaml"], seeds=1, workers=1, log="log.jsonl")
    told = [note for note in result.notes if "bridges" in note]
    assert told == [f"scene.yaml: a benchmark {SAID}"]
    assert [item.code for item in result.warnings["scene.yaml"]] == ["bridges-not-opened"]
    assert result.warnings["plain.yaml"] == []
    assert logged("log.jsonl").notes == result.notes
    assert call("benchmark", "scene.yaml", "--seeds", "1", "--workers", "1").output.count(SAID) == 1


def test_a_suite() -> None:
    Path("suite.yaml").write_text(
        "suite: mine\nversion: 1\ntitle: t\nscenarios: [{name: one, file: scene.yaml}]\nsteps: 50\n"
        "seeds: {count: 1}\npolicies: {dash: dash}\n"
    )
    done = call("benchmark", "suite.yaml", "--workers", "1")
    assert done.exit_code == 0, done.output
    assert f"one: a benchmark {SAID}" in done.output


def test_pictures() -> None:
    done = call("render", "scene.yaml", "-o", "a.png", "--step", "3")
    assert f"a picture {SAID}" in done.stderr
    assert SAID not in done.stdout
    assert SAID not in call("render", "plain.yaml", "-o", "a.png", "--step", "3").stderr
    assert SAID not in call("render", "scene.yaml", "-o", "a.png").stderr, "nothing is simulated before the start"
    answer = json.loads(call("render", "scene.yaml", "-o", "a.png", "--strip", "2", "--json").stdout)
    assert [item["code"] for item in answer["warnings"]] == ["bridges-not-opened"]
    assert call("render", "scene.yaml", "-o", "a.gif", "--step", "2").stderr.count(SAID) == 1
    assert [item.code for item in api.snapshot("scene.yaml", steps=2, draw=False).warnings] == ["bridges-not-opened"]
    assert api.snapshot("scene.yaml", draw=False).warnings == []


def test_training() -> None:
    Path("task.yaml").write_text(TASK)
    report = task_report("task.yaml")
    assert report.valid, report
    (finding,) = [item for item in report.findings if item.code == "bridges-not-opened"]
    assert (finding.severity, finding.message) == ("warning", f"training {SAID}")
    assert f"training {SAID}" in " ".join(call("validate", "task.yaml").output.split())
