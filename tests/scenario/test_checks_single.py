"""Hints and warnings about horizons, crowds, steps and bridges: each where it holds, and its fix."""

from __future__ import annotations

import re
from typing import Any

import pytest

import irsim
from irsim.env import Env
from irsim.results.findings import Finding
from irsim.scenario.open import read_scenario
from tests.bridges.peer import Peer


def named(code: str, text: str) -> list[Finding]:
    """Findings of this code about a scenario."""
    return [finding for finding in irsim.validate(text=text).findings if finding.code == code]


BRAKES = (
    "world: {width: 20, height: 20}\nrobot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, "
    "state: [1, 5, 0], goal: [18, 5], vel_max: [1.2, 2], vel_min: [0, -2], "
)
SHELF = "\nobstacle: {shape: {name: rectangle, length: 2, width: 1}, state: [9, 5, 0]}"

FOLLOW = "behavior: {name: follow, local: {name: footprint_orca, timeHorizon: 1.8}}"


@pytest.mark.parametrize(
    ("more", "says", "fix"),
    [
        ("acce: [1, 4], behavior: {name: footprint_orca}}" + SHELF,
         "1.2 m/s at 1 m/s^2 in 1.2 s and 0.72 m, but footprint_orca looks 0.5 s ahead at what stands",
         f"where something large stands in the way, {FOLLOW}"),
        ("acce: [1, 4], behavior: {name: orca, timeHorizonObst: 0.5}}" + SHELF,
         "0.72 m, but orca looks 0.5 s ahead at what stands", "timeHorizonObst: 1.8"),
        ("acce: [1, 4], number: 2, distribution: {name: random}, behavior: {name: orca, timeHorizon: 1}}" + SHELF,
         "but orca looks 1 s ahead at what moves", "timeHorizon: 1.8"),
        ("acce: [1, 4], number: 2, distribution: {name: random}, "
         "behavior: {name: follow, local: {name: orca, timeHorizon: 1, timeHorizonObst: 0.5}}}" + SHELF,
         "but orca looks 1 s ahead at what moves", "timeHorizon: 1.8"),
        ("acce: [1, 4], behavior: {name: rvo, vxmax: 1.2, vymax: 1.2}}" + SHELF,
         "", None),  # it brakes in time
        ("acce: [1, 4], behavior: {name: orca}}" + SHELF, "", None),
        ("acce: [4, 4], behavior: {name: footprint_orca}}" + SHELF, "", None),
        ("behavior: {name: footprint_orca}}" + SHELF, "", None),
        ("acce: [1, 4], behavior: {name: footprint_orca}}", "", None),
        ("acce: [1, 4], behavior: {name: footprint_orca, maxSpeed: 0.4}}" + SHELF, "", None),
    ],
)  # fmt: skip
def test_horizons_shorter_than_braking_are_named(more: str, says: str, fix: str | None) -> None:
    hints = named("brakes-too-late", BRAKES + more)
    assert [(hint.severity, hint.fix) for hint in hints] == ([("hint", fix)] if says else [])
    assert all(says in hint.message for hint in hints)


@pytest.mark.parametrize("behavior", ["orca", "avocado"])
def test_advice_to_follow_names_a_horizon_that_works(behavior: str) -> None:
    text = (
        "world: {width: 20, height: 12}\nrobot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, "
        f"state: [2, 6, 0], goal: [18, 6], vel_max: [1.2, 2], vel_min: [0, -2], acce: [1, 4], "
        f"behavior: {{name: {behavior}}}}}\n"
        "obstacle: {shape: {name: linestring, vertices: [[7, 1], [10, 1], [10, 11], [7, 11]]}, state: [0, 0, 0]}"
    )
    result = irsim.run(text=text, seed=1)
    advice = f"{{name: follow, local: {{name: {behavior}, timeHorizon: 1.8}}}}"
    assert result.outcome == "timeout"
    assert advice in str(result.reason)
    mended = irsim.run(text=text.replace(f"{{name: {behavior}}}", advice), seed=1)
    assert mended.outcome == "success", mended.reason


CROWD = """
world: {{width: 10, height: 10, time_limit: 40{mode}}}
{role}:
  - number: {number}
    kinematics: {{name: omni}}
    shape: {{name: circle, radius: 0.25}}
    distribution: {{name: random}}
    behavior: {behavior}
"""
WANDER = "{name: sfm, wander: true}"


def crowd(number: int = 12, behavior: str = WANDER, role: str = "obstacle", mode: str | None = None) -> str:
    written = "" if mode is None else f", collision_mode: {mode}"
    return CROWD.format(number=number, behavior=behavior, role=role, mode=written)


def stopped(text: str) -> int:
    """Objects that stand for good after 40 s."""
    env = Env(read_scenario(text=text, strict=True)[0], seed=1, headless=True, log_level="ERROR")
    env.rollout(400, until_done=False)
    return sum(bool(view.stop_flag) for view in env.objects)


@pytest.mark.parametrize(
    ("text", "fix"),
    [
        (crowd(), "unobstructed_obstacles"),
        (crowd(mode="stop"), "unobstructed_obstacles"),
        (crowd(2), "unobstructed_obstacles"),
        (crowd(role="robot"), "unobstructed"),
        (crowd(behavior="{name: follow, local: sfm, wander: true}"), "unobstructed_obstacles"),
        (crowd(behavior="{name: sfm}"), "unobstructed_obstacles"),
        *((crowd(mode=mode), None) for mode in ("unobstructed_obstacles", "unobstructed", "contact")),
        (crowd(behavior="{name: orca, wander: true}"), None),
        (crowd(1), None),
        (crowd(3, behavior="{name: sfm}"), None),
        (crowd(role="robot", behavior="{name: sfm}"), None),
    ],
)
def test_a_crowd_that_freezes_is_reported_with_the_mode_that_lets_it_go_on(text: str, fix: str | None) -> None:
    hints = named("crowd-stops", text)
    assert [hint.severity for hint in hints] == ["hint"] * bool(fix)
    assert all(f"collision_mode: {fix}" in str(hint.fix) for hint in hints)


def test_with_the_fix_no_object_freezes() -> None:
    assert stopped(crowd()) > 6
    assert stopped(crowd(mode="unobstructed_obstacles")) == 0


ROBOT = (
    "world: {{step_time: {dt}, integration: {integration}, {world}}}\n"
    "robot: {{kinematics: {{name: {drive}}}, shape: {{name: circle, radius: {radius}}}, state: [1, 1, 0], "
    "goal: [9, 9], vel_max: {top}, vel_min: {low}, goal_threshold: 0.5, behavior: {{name: orca}}}}\n"
)


USUAL = {"drive": "diff", "radius": 0.2, "top": "[1, 1]", "low": "[-1, -1]"}


def coarse(dt: float = 0.1, integration: str = "euler", world: str = "contacts: step_end", **keys: Any) -> list[Any]:
    return named("coarse-steps", ROBOT.format(dt=dt, integration=integration, world=world, **{**USUAL, **keys}))


def test_a_step_longer_than_half_of_the_body() -> None:
    assert not coarse(top="[2, 1]", low="[-2, -1]")  # 0.2 m of 0.4 m
    limits = {"top": "[2.1, 1]", "low": "[-2.1, -1]"}
    (finding,) = coarse(**limits)
    assert finding.severity == "hint"
    assert "0.21 m in a step of 0.1 s, more than half of its size (0.4 m)" in finding.message
    assert "it decides, and contacts are judged, only that often" in finding.message
    assert "world.step_time: 0.09 or less" in str(finding.fix)
    assert coarse(dt=0.09, **limits) == []
    assert len(coarse(integration="exact", **limits)) == 1  # arcs are as long
    for world in ("contacts: swept", "collision_mode: contact"):
        (finding,) = coarse(world=world, **limits)
        assert "(0.4 m): it decides only that often" in finding.message
    for low in ("[-1]", "[]"):
        assert coarse(low=low) == [], "limits of a wrong length are another finding"
    assert not coarse(radius=0.15, top="[1.5, 3]", low="[-1.5, -3]")


@pytest.mark.parametrize(
    ("drive", "top", "low"), [("diff", "[0.2, 3]", "[-0.2, -3]"), ("omni_angular", "[0.2, 0.2, 3]", "[-0.2, -0.2, -3]")]
)
def test_a_turn_by_more_than_half_a_radian(drive: str, top: str, low: str) -> None:
    assert not coarse(drive=drive, top=top, low=low)
    (finding,) = coarse(0.2, drive=drive, top=top, low=low)
    assert all(words in finding.message for words in ("0.6 rad in a step of 0.2 s", "off by up to 0.04 m"))
    assert all(words in str(finding.fix) for words in ("integration: exact", "world.step_time: 0.1 or less"))
    assert not coarse(0.2, "exact", drive=drive, top=top, low=low)


@pytest.mark.parametrize("speed", [0.3, 1.0, 2.0])
@pytest.mark.parametrize("rate", [0.4, 1.0, 6.0])
@pytest.mark.parametrize("dt", [0.1, 0.3, 1.0])
def test_each_fix_cures(speed: float, rate: float, dt: float) -> None:
    limits = {"top": f"[{speed}, {rate}]", "low": f"[{-speed}, {-rate}]"}
    for finding in coarse(dt, **limits):
        (step,) = re.findall(r"world.step_time: ([0-9.]+) or less", finding.fix)
        assert not coarse(float(step), **limits)
        if "integration: exact" in finding.fix:
            assert not coarse(dt, integration="exact", **limits)


WORLD = "world: {width: 10, height: 10, time_limit: 1, step_time: 0.1}\n"
PLACED = "kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [2, 2, 0]"


def driven(robots: str, bridge: str) -> list[str]:
    report = irsim.validate(text=f"{WORLD}robot: {robots}\nbridges: [{{{bridge}}}]\n")
    assert report.valid, report.findings
    codes = ("driven-without-goal", "default-goal", "outside-world")
    return [f"{f.code} {f.severity} {f.path}" for f in report.findings if f.code in codes]


TWO = f"{{name: a, {PLACED}}}, {{name: b, {PLACED}, goal: [8, 8]}}"
WITHOUT_GOAL = ["driven-without-goal warning robot[0]"]


@pytest.mark.parametrize(
    ("robots", "bridge", "expected"),
    [
        *((f"{{{PLACED}}}", bridge, WITHOUT_GOAL) for bridge in (
            "name: ros2", "name: ros1", "name: rosbridge, mode: real", "name: json_lines",
            "name: carla, follow: {robot_0: hero}", "name: ros2, robots: [robot_0]",
        )),
        *((TWO, bridge, []) for bridge in ("name: rosbag", "name: mujoco", "name: carla", "name: ros2, robots: [b]")),
        *((f"{{{PLACED}, {keys}}}", "name: ros2", []) for keys in (
            "goal: [8, 8]", "waypoints: [[4, 4], [8, 8]]", "goal: [1000, 0]", "behavior: {name: dash, wander: true}",
            "static: true",
        )),
        (f"{{{PLACED}, goal: [1000, 0], behavior: {{name: dash}}}}", "name: ros2",
            ["outside-world hint robot[0].goal"]),
    ],
)  # fmt: skip
def test_a_program_may_drive_a_robot_without_a_goal(robots: str, bridge: str, expected: list[str]) -> None:
    assert driven(f"[{robots}]", bridge) == expected


def test_one_warning_takes_the_place_of_the_hint_and_names_robots_of_an_entry() -> None:
    robots = f"[{{number: 2, {PLACED.replace('[2, 2, 0]', '[[2, 2, 0], [4, 2, 0]]')}, behavior: {{name: dash}}}}]"
    assert driven(robots, "name: ros2") == WITHOUT_GOAL
    [warning] = named("driven-without-goal", f"{WORLD}robot: {robots}\nbridges: [{{name: ros2}}]")
    words = "ros2 may drive 'robot_0', 'robot_1': without 'goal' they arrive at [1, 9, 0], and may end the run"
    assert warning.message == words


def test_a_bridge_of_the_command_is_checked_too() -> None:
    with Peer(lambda message: None) as peer:
        bridge = {"name": "json_lines", "address": peer.address}
        result = irsim.run(text=f"{WORLD}robot: [{{{PLACED}}}]\n", seed=0, bridges=[bridge])
    assert [w.path for w in result.warnings if w.code == "driven-without-goal"] == ["robot[0]"]
