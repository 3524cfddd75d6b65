"""`irsim audit` follows drives with inner states: their motion is worked out again from the controls alone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.runs.audit.conftest import audited, change_json, codes

SCENE = """\
world: {width: 20, height: 20, step_time: 0.1, time_limit: 8, integration: INTEGRATION, contacts: swept}
robot:
  - {name: one, kinematics: {DRIVE}, shape: {name: circle, radius: 0.3}, state: [5, 5, 0], goal: [14, 14, 0],
     behavior: {name: dash}}
  - {name: two, kinematics: {DRIVE}, shape: {name: circle, radius: 0.3}, state: [3, 12, -1], goal: [9, 3, 0],
     behavior: {name: orca}}
obstacle:
  - {shape: {name: circle, radius: 0.4}, state: [6.5, 6.4, 0]}
"""
DRIVES = {
    "tricycle": ("name: tricycle, wheelbase: 0.8", "wheelbase"),
    "lagged": ("name: tricycle, wheelbase: 0.8, steer_rate: 1.2, steer_acce: 6, steer_lag: 0.1", "steer_lag"),
    "diff_dynamic": ("name: diff_dynamic, mass: 25.0, torque_max: 1.0", "mass"),
    "single_track": ("name: single_track, acce_max: 2.5", "acce_max"),
    "kinematic": ("name: single_track, model: kinematic, mode: angular, steer_rate: 0.8", "wheelbase"),
    "skid_steer": ("name: skid_steer, preset: jackal, traction_left: 0.9, icr_ahead: 0.1", "icr_ahead"),
    "by_rate": ("name: tricycle, wheelbase: 0.8, mode: angular, steer_rate: 0.7, steer_lag: 0.1", "steer_lag"),
}
"""Options of each drive, and one on which its motion depends."""


@pytest.mark.parametrize("integration", ["euler", "exact"])
@pytest.mark.parametrize("drive", DRIVES)
def test_a_run_is_the_motion_of_its_drive(record: Callable[..., Path], drive: str, integration: str) -> None:
    options, key = DRIVES[drive]
    folder = record(SCENE.replace("DRIVE", options).replace("INTEGRATION", integration))
    result = audited(folder)
    assert result.equal, result.findings
    motion = next(check for check in result.checks if check.name == "motion")
    assert "left out" not in str(motion)

    def other(data: Any) -> None:
        for entry in data["options"]:
            if key in (entry.get("kinematics") or {}):
                entry["kinematics"][key] *= 1.5
            if entry.get("wheelbase") and key == "wheelbase":
                entry["wheelbase"] *= 1.5

    change_json(folder / "resolved.json", other)
    change_json(folder / "run.json", lambda data: data.update(resolved=None))
    assert codes(audited(folder)) == {"audit-motion"}
