"""Suites: what is checked of their scenarios, values of all scenarios, and what the second versions say."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from typer.testing import CliRunner

from irsim.benchmarks.suite import SUITES, SuiteError, load_suite
from irsim.benchmarks.suite_plan import suite_plan
from irsim.cli.app import app
from irsim.validation.file_reports import suite_report
from tests.benchmarks.test_suite import written

SWAP = {
    "world": {"width": 10, "height": 10},
    "robot": [
        {"number": 2, "kinematics": {"name": "omni"}, "state": [[1, 5, 0], [9, 5, 0]], "goal": [[9, 5], [1, 5]]},
    ],
}  # fmt: skip


def test_validate_checks_the_scenarios_of_a_suite_under_its_policies(tmp_path: Path) -> None:
    policies = {"plain": {"name": "orca", "sidestep": 0}, "usual": "orca"}
    file = written(tmp_path, scenarios=[{"name": "swap", "scenario": SWAP}], policies=policies)
    report = suite_report(str(file))
    assert (report.valid, report.warnings, report.summary.rpartition("; ")[2]) == (True, 1, "1 warning")
    [finding] = report.findings
    assert (finding.code, finding.path) == ("exact-symmetry", "scenarios[0].scenario.robot[0].behavior")
    assert finding.line is not None
    assert "scenario 'swap' under the policy 'plain'" in finding.message
    written(tmp_path, scenarios=[{"name": "swap", "scenario": SWAP}], policies=policies, perturb=[{"position": 0.1}])
    assert suite_report(str(file)).findings == []  # no seed has the exact symmetry


def test_warnings_of_a_bundled_suite_show_its_lines() -> None:
    result = CliRunner().invoke(app, ["validate", "crowdnav_circle_v1"])
    assert result.exit_code == 0
    assert "crowdnav_circle_v1:33:25" in result.output
    assert "scenario 'circle-invisible'" in result.output


def test_values_of_all_scenarios_and_a_horizon_in_seconds(tmp_path: Path) -> None:
    scenarios = [
        {"name": "fast", "template": "crossing", "vary": {"courier_speed": [0.8], "world.step_time": [0.05, 0.2]}},
        {"name": "own", "scenario": SWAP, "overrides": {"robot[*].acce": [3, 3]}},
    ]
    always = {"world.contacts": "swept", "robot[*].acce": [1, 4]}
    file = written(tmp_path, scenarios=scenarios, overrides=always, steps=None, seconds=6)
    made = {one.name: yaml.safe_load(one.text) for one in suite_plan(str(file)).scenarios}
    assert list(made) == ["fast-0.8-0.05", "fast-0.8-0.2", "own"]
    assert {name: data["world"]["time_limit"] for name, data in made.items()} == dict.fromkeys(made, 6.0)
    assert {data["world"]["contacts"] for data in made.values()} == {"swept"}
    assert [made["fast-0.8-0.05"]["world"]["step_time"], made["own"]["robot"][0]["acce"]] == [0.05, [3, 3]]
    assert all(robot["acce"] == [1, 4] for robot in made["fast-0.8-0.2"]["robot"])
    for wrong in ({"steps": 10, "seconds": 6}, {"steps": None}):
        with pytest.raises(SuiteError, match="give either steps or seconds"):
            load_suite(str(written(tmp_path, **wrong)))


def test_suites_of_the_second_version_say_what_the_first_left_open() -> None:
    """Contacts within steps count, arcs are exact, accelerations are limited, and other periods are part of it."""
    assert {name.replace("_v1", "_v2") for name in SUITES.names()} <= {*SUITES.names()}
    for name in (name.replace("_v1", "_v2") for name in SUITES.names() if name.endswith("_v1")):
        plan = suite_plan(name)
        scenes = [yaml.safe_load(one.text) for one in plan.scenarios]
        assert {(one["world"]["contacts"], one["world"]["integration"]) for one in scenes} == {("swept", "exact")}
        assert all(robot["acce"] for one in scenes for robot in one["robot"]), name
        assert {one.protocol for one in plan.scenarios} == {"freeze", "yield"}
        assert len({one["world"].get("step_time", 0.1) for one in scenes}) >= 3, name
        assert min(plan.seeds) == 100_000
