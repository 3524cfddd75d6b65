"""`irsim audit` recomputes motion on ground on which wheels slip, and decisions of robots that go by an estimate."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
import irsim._core as core
from irsim.runs.audit.ground import _SLIP_STREAM
from tests.runs.audit.conftest import TEMPLATES, audited, change_json, change_piece, codes

HALL = """\
world:
  width: 20
  height: 20
  step_time: 0.1
  time_limit: 12
  integration: INTEGRATION
  contacts: swept
  zones:
    - {name: wet, polygon: [[4, 4.97], [9, 4], [12, 13], [5, 9]], slip: 0.3, slip_std: 0.1, grip: 0.5}
    - {name: yard, rectangle: [7, 6, 9, 8.13], surface: gravel, slip: 0.1}
    - {name: ice, circle: {center: [10, 10], radius: 1.3}, slip: 0.4, slip_std: 0.2, slip_time: 0, grip: 0.2}
    - {name: gate, line: [[6, 0], [6, 20]]}
robot:
  - {name: one, kinematics: {DRIVE}, shape: {name: circle, radius: 0.3}, state: [5, 5.2, 0.4], goal: [14, 14, 0],
     behavior: {name: dash}}
  - {name: two, kinematics: {DRIVE}, shape: {name: rectangle, length: 0.7, width: 0.5}, state: [3, 12, -1],
     goal: [9, 3, 0], start_time: 0.35, behavior: {name: orca}}
obstacle:
  - {shape: {name: circle, radius: 0.4}, state: [6.5, 6.4, 0]}
"""
DRIVES = {
    "diff": ("name: diff, track: 0.5", "slip"),
    "width": ("name: diff", "slip_std"),
    "omni": ("name: omni", "slip_std"),
    "omni_angular": ("name: omni_angular", "slip"),
    "acker": ("name: acker, wheelbase: 0.6", "slip_time"),
    "tricycle": ("name: tricycle, wheelbase: 0.8, steer_rate: 1.2, steer_lag: 0.1", "slip"),
    "skid_steer": ("name: skid_steer, preset: jackal", "surface"),
    "single_track": ("name: single_track, acce_max: 2.5", "grip"),
    "kinematic": ("name: single_track, model: kinematic, mode: angular, steer_rate: 0.8", "slip"),
    "diff_dynamic": ("name: diff_dynamic, mass: 25.0, friction: 0.6, slip_stiffness: 20.0", "grip"),
}
"""Options of each drive, and a key of the ground on which its motion depends."""
OTHER = {"slip": 0.25, "slip_std": 0.11, "slip_time": 1.3, "grip": 0.1, "surface": "sand"}


@pytest.mark.parametrize("integration", ["euler", "exact"])
@pytest.mark.parametrize("drive", DRIVES)
def test_wheels_slip_as_their_ground_says(record: Callable[..., Path], drive: str, integration: str) -> None:
    options, key = DRIVES[drive]
    folder = record(HALL.replace("DRIVE", options).replace("INTEGRATION", integration))
    result = audited(folder)
    assert result.equal, result.findings
    assert "left out" not in str(result.checks[0])

    def other(data: Any) -> None:
        for zone in data["world"]["zones"]:
            if zone[key]:
                zone[key] = OTHER[key]

    change_json(folder / "resolved.json", other)
    change_json(folder / "run.json", lambda data: data.update(resolved=None))
    assert codes(audited(folder)) == {"audit-motion"}


def test_the_stream_of_slip_is_the_one_of_the_engine() -> None:
    assert core.STREAMS["slip"] == _SLIP_STREAM


def test_another_seed_is_found_in_the_slip(record: Callable[..., Path]) -> None:
    folder = record(HALL.replace("DRIVE", "name: diff").replace("INTEGRATION", "exact"))
    change_json(folder / "run.json", lambda data: data.update(seed=1))
    assert codes(audited(folder)) == {"audit-motion"}


def test_a_drive_whose_tyres_hold_little_needs_no_zone(record: Callable[..., Path]) -> None:
    options = "name: diff_dynamic, mass: 25.0, friction: 0.02"
    text = HALL.replace("DRIVE", options).replace("INTEGRATION", "exact")
    begin, end = text.index("  zones:"), text.index("robot:")
    result = audited(record(text[:begin] + text[end:]))
    assert result.equal, result.findings


def test_a_wheel_on_the_edge_of_ground_is_left_out_and_named(record: Callable[..., Path]) -> None:
    text = """\
world: {width: 10, height: 10, time_limit: 8, zones: [{name: wet, rectangle: [3, 4.5, 5, 4.8], slip: 0.5}]}
robot: {kinematics: {name: diff, track: 0.4}, state: [1, 5, 0], goal: [9, 5], behavior: {name: dash}}
"""
    result = audited(record(text))
    assert result.equal, result.findings
    motion = result.checks[0]
    assert motion.status == "equal"
    assert "steps left out: a wheel is, or was, on the edge of ground on which it slips" in motion.note
    assert 0 < int(motion.note.split()[0]) < 40


@pytest.mark.parametrize(
    ("template", "step"), [("slippery-hall", 80), ("noisy-warehouse", 60), ("kidnapped", 60), ("race", 60)]
)
def test_a_moved_pose_of_a_template_is_found(workspace: Path, template: str, step: int) -> None:
    irsim.run(TEMPLATES / template / "scenario.yaml", seed=1, steps=120, record="kept")
    result = audited("kept")
    assert result.equal, result.findings
    assert all(check.status == "equal" for check in result.checks)
    assert all("left out" not in check.note for check in result.checks)
    change_piece(Path("kept"), lambda about, arrays: np.add.at(arrays["pose"], (step, 0, 1), 1e-5))
    moved = [finding for finding in audited("kept").findings if finding.code == "audit-motion"]
    assert [finding.step for finding in moved] == [step, step + 1]


def test_a_waypoint_that_a_robot_believes_to_pass(workspace: Path) -> None:
    irsim.run(TEMPLATES / "slippery-hall" / "scenario.yaml", seed=1, steps=200, record="kept")
    result = audited("kept")
    assert result.equal, result.findings
    assert "estimates and tracks are taken as their sensors reported them" in result.checks[3].note

    def later(about: dict[str, Any], arrays: dict[str, Any]) -> None:
        [event] = [event for event in about["events"] if event["kind"] == "waypoint"]
        about["goal_rows"][1] += 4
        event["step"] += 4

    change_piece(Path("kept"), later)
    findings = [finding for finding in audited("kept").findings if "does not pass the waypoint" in finding.message]
    assert len(findings) == 4
    assert {(finding.code, finding.object) for finding in findings} == {("audit-arrival", "runner")}


def test_a_believed_arrival_that_was_invented(workspace: Path) -> None:
    irsim.run(TEMPLATES / "kidnapped" / "scenario.yaml", seed=1, record="kept")
    assert audited("kept").equal

    def invent(about: dict[str, Any], arrays: dict[str, Any]) -> None:
        arrays["flags"][-1, 0] = 0

    change_piece(Path("kept"), invent)
    assert any("believes to be at its goal" in finding.message for finding in audited("kept").findings)


def test_estimates_that_were_not_recorded_are_named(workspace: Path) -> None:
    irsim.run(TEMPLATES / "slippery-hall" / "scenario.yaml", seed=1, steps=50, record="kept")
    change_piece(Path("kept"), lambda about, arrays: about.update(reading_rows=[]))
    result = audited("kept")
    assert result.equal
    assert "1 left out: decides from an estimate that is not in the record" in result.checks[3].note
