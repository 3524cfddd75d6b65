"""`irsim audit` recomputes a run from its files: closed-form contacts, and every change of a record is found."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.runs.audit.conftest import audited, change_json, change_piece, codes, discs

BOX_BESIDE_WALL = """\
world: {width: 10, height: 10, step_time: 0.1, time_limit: 10, contacts: swept}
robot:
  - {name: box, kinematics: {name: omni}, shape: {name: rectangle, length: 1, width: 1}, state: [2, 5, 0],
     goal: [4, 5, 0], vel_max: [1, 1], vel_min: [-1, -1], behavior: {name: dash}}
obstacle:
  - {name: wall, shape: {name: polygon, vertices: [[0, 4], [10, 4], [10, 4.5], [0, 4.5]]}, state: [0, 0, 0]}
"""

CAR = """\
world: {width: 20, height: 20, step_time: 0.1, time_limit: 8, integration: exact}
robot:
  - {name: car, kinematics: {name: acker}, shape: {name: rectangle, length: 2, width: 1, wheelbase: 1.2},
     state: [5, 5, 0, 0], goal: [14, 14, 0], vel_max: [2, 0.6], vel_min: [-2, -0.6], acce: [1, 1],
     behavior: {name: dash}}
"""


def test_discs_that_meet_within_a_step(record: Callable[..., Path]) -> None:
    folder = record(discs())
    result = audited(folder)
    assert result.equal, result.findings
    assert [robot.contacts for robot in result.robots] == [1, 1]
    assert result.outcome == "collision"
    assert all(robot.path_length == pytest.approx(1.25, abs=1e-6) for robot in result.robots)
    assert all(robot.mean_speed == pytest.approx(1.25 / 1.5, abs=1e-6) for robot in result.robots)
    assert result.unseen_depth < 1e-7


def test_a_contact_at_another_time_is_found(record: Callable[..., Path]) -> None:
    folder = record(discs("unobstructed"))
    assert audited(folder).equal

    def later(about: dict[str, Any], arrays: dict[str, Any]) -> None:
        [event] = [event for event in about["events"] if event["kind"] == "collision"]
        assert event["time"] == pytest.approx(1.25, abs=1e-6)
        event["time"] = 1.4

    change_piece(folder, later)
    [finding] = audited(folder).findings
    assert finding.code == "audit-contact"
    assert finding.step == 3
    assert finding.recorded == 1.4
    assert finding.recomputed == pytest.approx(1.25, abs=1e-6)


def test_discs_that_pass_between_the_ends_of_a_step_are_found(record: Callable[..., Path]) -> None:
    fast = discs("unobstructed", "step_end").replace("[1, 1]", "[20, 1]").replace("radius: 0.5", "radius: 0.1")
    folder = record(fast)
    result = audited(folder)
    assert result.equal, result.findings
    assert [robot.contacts_between_steps for robot in result.robots] == [1, 1]
    change_piece(folder, lambda about, arrays: about["events"].clear())
    assert "audit-contact" in codes(audited(folder))


def test_a_polygon_that_only_touches_is_named_within_the_tolerance(record: Callable[..., Path]) -> None:
    result = audited(record(BOX_BESIDE_WALL))
    assert result.equal, result.findings
    assert [(near.object, near.partner) for near in result.within_tolerance[:1]] == [("box", "wall")]
    assert abs(result.within_tolerance[0].gap) <= result.tolerance


def test_a_polygon_that_overlaps_is_no_matter_of_tolerance(record: Callable[..., Path]) -> None:
    result = audited(record(BOX_BESIDE_WALL.replace("[2, 5, 0]", "[2, 4.99, 0]")))
    assert result.equal
    assert result.within_tolerance == []
    assert result.robots[0].contacts == 1
    assert result.robots[0].min_clearance == pytest.approx(-0.01, abs=1e-9)


def test_a_car_moves_as_its_wheelbase_says(record: Callable[..., Path]) -> None:
    folder = record(CAR)
    assert audited(folder).equal

    def longer(data: Any) -> None:
        data["options"][0]["wheelbase"] = 1.5

    change_json(folder / "resolved.json", longer)
    change_json(folder / "run.json", lambda data: data.update(resolved=None))
    result = audited(folder)
    assert codes(result) == {"audit-motion"}


def test_a_moved_pose_is_found_at_its_step(record: Callable[..., Path]) -> None:
    folder = record(discs())
    change_piece(folder, lambda about, arrays: np.add.at(arrays["pose"], (2, 0, 1), 1e-5))
    moved = [finding for finding in audited(folder).findings if finding.code == "audit-motion"]
    assert [(finding.object, finding.step) for finding in moved] == [("left", 2), ("left", 3)]
    assert moved[0].tolerance == pytest.approx(0.0, abs=1e-6)


def test_a_changed_outcome_is_found(record: Callable[..., Path]) -> None:
    folder = record(discs())
    change_json(folder / "result.json", lambda data: data.update(outcome="success"))
    [finding] = audited(folder).findings
    assert (finding.code, finding.recorded, finding.recomputed) == ("audit-outcome", "success", "collision")


@pytest.mark.parametrize(("key", "value"), [("path_length", 1.2), ("collision_count", 0), ("min_clearance", 0.4)])
def test_a_changed_metric_is_found(record: Callable[..., Path], key: str, value: float) -> None:
    folder = record(discs())
    change_json(folder / "result.json", lambda data: data["robots"][0].update({key: value}))
    [finding] = audited(folder).findings
    assert finding.code == "audit-metric"
    assert finding.object == "left"
    assert key in finding.message


@pytest.mark.parametrize("contacts", ["swept", "step_end"])
def test_a_removed_contact_is_found_even_if_all_flags_follow(record: Callable[..., Path], contacts: str) -> None:
    folder = record(discs(contacts=contacts))

    def innocent(about: dict[str, Any], arrays: dict[str, Any]) -> None:
        about["events"] = []
        arrays["flags"][:] = 0

    change_piece(folder, innocent)
    assert codes(audited(folder)) & {"audit-contact", "audit-motion"}


def test_an_invented_contact_is_found(record: Callable[..., Path]) -> None:
    folder = record(discs())

    def earlier(about: dict[str, Any], arrays: dict[str, Any]) -> None:
        about["events"].insert(0, {**about["events"][0], "step": 1, "time": 0.5})

    change_piece(folder, earlier)
    result = audited(folder)
    assert [finding.step for finding in result.findings if finding.code == "audit-contact"] == [1]


def test_an_exceeded_limit_is_found(record: Callable[..., Path]) -> None:
    folder = record(CAR)
    change_json(folder / "run.json", lambda data: data.update(resolved=None))
    change_json(folder / "resolved.json", lambda data: data["built"]["acce"][0].__setitem__(0, 0.5))
    result = audited(folder)
    assert codes(result) == {"audit-limit"}
    finding = result.findings[0]
    assert (finding.object, finding.recomputed) == ("car", 0.5)
    assert finding.recorded == pytest.approx(1.0, rel=1e-5)


def test_a_goal_that_was_not_reached_is_found(record: Callable[..., Path]) -> None:
    folder = record(CAR.replace("[14, 14, 0]", "[14, 7, 0]"))
    assert audited(folder).outcome == "success"
    change_json(folder / "run.json", lambda data: data.update(resolved=None))
    change_json(folder / "resolved.json", lambda data: data["objects"][0].update(goals=[[16, 7, 0]]))
    assert codes(audited(folder)) == {"audit-arrival"}
    change_piece(folder, lambda about, arrays: np.add.at(arrays["goal"], (0, 0, 0), 2.0))
    assert codes(audited(folder)) == {"audit-arrival", "audit-metric"}


def test_a_drawn_outline_counts(record: Callable[..., Path]) -> None:
    text = discs().replace("{name: circle, radius: 0.5}", "{name: polygon, random_shape: true, is_convex: true}")
    folder = record(text)
    assert audited(folder).equal
    built = json.loads((folder / "resolved.json").read_text())["built"]
    assert [part["kind"] for parts in built["outlines"] for part in parts] == ["polygon", "polygon"]

    def larger(data: Any) -> None:
        for part in data["built"]["outlines"][0]:
            part["vertices"] = [[2 * x, 2 * y] for x, y in part["vertices"]]

    change_json(folder / "resolved.json", larger)
    assert codes(audited(folder)) == {"unreadable-run"}, "the digest in run.json tells"
    change_json(folder / "run.json", lambda data: data.update(resolved=None))
    assert {"audit-contact", "audit-metric"} <= codes(audited(folder))


def test_a_record_of_an_older_version_says_what_it_lacks(record: Callable[..., Path]) -> None:
    folder = record(discs())
    change_json(folder / "run.json", lambda data: data.update(resolved=None))
    change_json(folder / "resolved.json", lambda data: data.pop("built"))
    [problem] = audited(folder).problems
    assert problem.code == "record-incomplete"
    assert problem.fix


def test_a_run_that_ends_early_is_found(record: Callable[..., Path]) -> None:
    folder = record(CAR)

    def shorter(about: dict[str, Any], arrays: dict[str, Any]) -> None:
        about["rows"] -= 5
        arrays["pose"], arrays["control"] = arrays["pose"][:-5], arrays["control"][:-5]
        last = about["rows"]
        kept = [row < last for row in about["flag_rows"]]
        arrays["flags"], about["flag_rows"] = arrays["flags"][kept], [r for r in about["flag_rows"] if r < last]
        about["events"] = [event for event in about["events"] if event["step"] < last]

    change_piece(folder, shorter)
    steps = json.loads((folder / "result.json").read_text())["steps"]
    change_json(folder / "result.json", lambda data: data.update(steps=steps - 5, sim_time=(steps - 5) * 0.1))
    assert "audit-outcome" in codes(audited(folder))


def test_no_part_of_the_engine_takes_part(record: Callable[..., Path]) -> None:
    folder = record(discs())
    program = f"""
import sys
sys.modules["irsim._core"] = None  # importing it now fails
from irsim.runs.audit.audit import audit_runs
result = audit_runs([{str(folder)!r}])
assert result.equal, result.runs[0].findings
rooms = {{name.split(".")[1] for name in sys.modules if name.startswith("irsim.")}}
print(sorted(rooms & {{"simulation", "env", "scenario", "metrics", "objects", "navigation", "api"}}))
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "[]"


def test_numbers_that_are_none(record: Callable[..., Path]) -> None:
    folder = record(discs())

    def broken(data: Any) -> None:
        data["built"]["outlines"][0] = [{"kind": "polygon", "vertices": [[0, 0], [1, 1]]}]

    change_json(folder / "run.json", lambda data: data.update(resolved=None))
    change_json(folder / "resolved.json", broken)
    assert codes(audited(folder)) == {"unreadable-run"}
    change_piece(folder, lambda about, arrays: arrays["pose"].fill(math.inf))
    assert not audited(folder).equal
