"""Every bundled template, recorded for some steps, is equal to what an audit recomputes: as written, in other modes.

The other modes drive robots straight at each other, so that contacts of all kinds occur.
"""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
import yaml

import irsim
from tests.runs.audit.conftest import TEMPLATES, audited

NAMES = sorted(path.parent.name for path in TEMPLATES.glob("*/scenario.yaml"))
MODES = {
    "swept": {"collision_mode": "stop", "contacts": "swept", "integration": "exact", "step_time": 0.2},
    "passing": {"collision_mode": "unobstructed", "contacts": "swept", "integration": "exact", "step_time": 0.2},
    "chords": {"collision_mode": "unobstructed", "contacts": "step_end", "integration": "euler", "step_time": 0.25},
    "pushing": {"collision_mode": "contact", "contacts": "step_end", "step_time": 0.1},
}
UNPUSHED = ("single_track", "diff_dynamic")
"""Drives with speeds of their own, which contacts cannot change: another drive takes their place where bodies push."""


@pytest.mark.parametrize("name", NAMES)
def test_a_template_as_written(workspace: Path, name: str) -> None:
    irsim.run(TEMPLATES / name / "scenario.yaml", seed=1, steps=120, record="kept")
    result = audited("kept")
    assert result.equal, result.findings
    assert result.unseen_depth < 1e-6
    assert {check.name for check in result.checks} == {
        *("motion", "limits", "contacts", "arrivals", "outcome", "metrics"),
    }


@pytest.mark.slow
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", NAMES)
def test_a_template_in_another_mode(workspace: Path, name: str, mode: str) -> None:
    shutil.copytree(TEMPLATES / name, "other")
    data: dict[str, Any] = yaml.safe_load((TEMPLATES / name / "scenario.yaml").read_text(encoding="utf-8"))
    data["world"].update(MODES[mode])
    robots = data.get("robot", [])
    robots = robots if isinstance(robots, list) else [robots]
    for robot in [robot for robot in robots if not robot.get("static") and "kinematics" in robot]:
        turning = robot["kinematics"]["name"] == "omni_angular"
        robot["acce"] = [1.0, 2.0, 2.0] if turning else [1.0, 2.0]
        if mode == "pushing" and robot["kinematics"]["name"] in UNPUSHED:
            robot["kinematics"] = {"name": "acker", "wheelbase": 0.3}
    Path("other/scenario.yaml").write_text(yaml.safe_dump(data), encoding="utf-8")
    irsim.run("other/scenario.yaml", seed=2, steps=120, behavior="dash", record="kept")
    result = audited("kept")
    assert result.equal, result.findings
    assert result.unseen_depth < 1e-6
