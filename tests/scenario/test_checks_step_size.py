"""Steps that are long for the size of a body: hint `coarse-steps`."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import irsim

ROBOT = (
    "world: {{step_time: {dt}, integration: {integration}, {world}}}\n"
    "robot: {{kinematics: {{name: {drive}}}, shape: {{name: circle, radius: {radius}}}, state: [1, 1, 0], "
    "goal: [9, 9], vel_max: {top}, vel_min: {low}, goal_threshold: 0.5, behavior: {{name: orca}}}}\n"
)


def findings(
    dt: float = 0.1,
    drive: str = "diff",
    radius: float = 0.2,
    top: str = "[1, 1]",
    low: str = "[-1, -1]",
    integration: str = "euler",
    world: str = "contacts: step_end",
) -> list[Any]:
    text = ROBOT.format(dt=dt, drive=drive, radius=radius, top=top, low=low, integration=integration, world=world)
    return [finding for finding in irsim.validate(text=text).findings if finding.code == "coarse-steps"]


def test_a_step_longer_than_half_of_the_body() -> None:
    assert not findings(top="[2, 1]", low="[-2, -1]")  # 0.2 m of 0.4 m
    (finding,) = findings(top="[2.1, 1]", low="[-2.1, -1]")
    assert finding.severity == "hint"
    assert "0.21 m in a step of 0.1 s, more than half of its size (0.4 m)" in finding.message
    assert "it decides, and contacts are judged, only that often" in finding.message
    assert "world.step_time: 0.09 or less" in (finding.fix or "")
    assert findings(dt=0.09, top="[2.1, 1]", low="[-2.1, -1]") == []
    assert len(findings(top="[2.1, 1]", low="[-2.1, -1]", integration="exact")) == 1  # arcs are as long


@pytest.mark.parametrize(
    ("drive", "top", "low"), [("diff", "[0.2, 3]", "[-0.2, -3]"), ("omni_angular", "[0.2, 0.2, 3]", "[-0.2, -0.2, -3]")]
)
def test_a_turn_by_more_than_half_a_radian(drive: str, top: str, low: str) -> None:
    assert not findings(drive=drive, top=top, low=low)
    (finding,) = findings(0.2, drive, top=top, low=low)
    assert "0.6 rad in a step of 0.2 s" in finding.message
    assert "off by up to 0.04 m" in finding.message
    assert "integration: exact" in (finding.fix or "")
    assert "world.step_time: 0.1 or less" in (finding.fix or "")
    assert not findings(0.2, drive, top=top, low=low, integration="exact")


@pytest.mark.parametrize("speed", [0.3, 1.0, 2.0])
@pytest.mark.parametrize("rate", [0.4, 1.0, 6.0])
@pytest.mark.parametrize("dt", [0.1, 0.3, 1.0])
def test_each_fix_cures(speed: float, rate: float, dt: float) -> None:
    limits = {"top": f"[{speed}, {rate}]", "low": f"[{-speed}, {-rate}]"}
    for finding in findings(dt, **limits):
        (step,) = re.findall(r"world.step_time: ([0-9.]+) or less", finding.fix)
        assert not findings(float(step), **limits)
        if "integration: exact" in finding.fix:
            assert not findings(dt, integration="exact", **limits)


@pytest.mark.parametrize("world", ["contacts: swept", "collision_mode: contact"])
def test_where_contacts_within_steps_count(world: str) -> None:
    (finding,) = findings(top="[2.1, 1]", low="[-2.1, -1]", world=world)
    assert "(0.4 m): it decides only that often" in finding.message


@pytest.mark.parametrize("low", ["[-1]", "[]"])
def test_limits_of_wrong_lengths_are_no_business_of_it(low: str) -> None:
    assert findings(low=low) == []


def test_ordinary_robots_and_all_templates_are_not_coarse() -> None:
    assert not findings(radius=0.15, top="[1.5, 3]", low="[-1.5, -3]")
    for path in sorted(Path("templates").glob("*/scenario.yaml")):
        codes = [finding.code for finding in irsim.validate(path).findings]
        assert not {"coarse-steps", "crowd-stops", "heading-not-reached"} & set(codes), path
