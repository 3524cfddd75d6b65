"""`avoid` and `within` of `follow`: zones that the body stays out of, a region that the path does not leave."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import irsim
from tests.env.driving import Make, take_steps

RADIUS, ZONE_RADIUS = 0.25, 1.2
PLAZA = """
world:
  width: 12
  height: 12
  zones:
    - {{name: talk, circle: {{center: [6, 6], radius: 1.2}}}}
    - {{name: door, line: [[1, 3], [11, 3]]}}
    - {{name: desk, rectangle: [8, 8, 11, 11]}}
robot:
  - {{name: scout, kinematics: {{name: {drive}}}, shape: {{name: circle, radius: 0.25}}, state: {state}, goal: {goal},
     vel_max: {limits}, behavior: {{name: follow, planner: {planner}, local: {local}, avoid: {avoid}}},
     goal_threshold: 0.2}}
obstacle:
  - {{number: 3, tags: [pedestrian], kinematics: {{name: static}}, shape: {{name: circle, radius: 0.25}},
     distribution: {{name: circle, center: [6, 6], radius: 0.8}}}}
"""
# a corridor along x, open at both ends, and closed in the middle but for a detour around its outside
CORRIDOR = """
world: {{width: 20, height: 12}}
robot: {{kinematics: {{name: {drive}}}, shape: {{name: circle, radius: 0.2}}, state: [3, 6, 0], goal: [17, 6],
  behavior: {{name: follow, planner: {planner}{within}}}, vel_max: {limits}, goal_threshold: 0.2}}
obstacle:
  - {{shape: {{name: linestring, vertices: [[4, 5], [16, 5]]}}, state: [0, 0, 0]}}
  - {{shape: {{name: linestring, vertices: [[4, 7], [16, 7]]}}, state: [0, 0, 0]}}
  - {{shape: {{name: rectangle, length: 0.4, width: 2.2}}, state: [10, {middle}, 0]}}
"""
DRIVES = ["diff", "omni", "omni_angular", "acker"]
VISITOR = """
  - {name: anna, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, behavior: {name: dash},
     state: [9, 7.6, 0], goal: [9, 11]}
"""
PEOPLE = """
  - {number: 4, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, behavior: {name: dash},
     state: [[3.5, 10, 0], [4.2, 11, 0], [7.8, 10.5, 0], [8.5, 9.5, 0]],
     goal: [[3.5, 1], [4.2, 1], [7.8, 1], [8.5, 1]]}
"""


def limits(drive: str) -> list[int]:
    return [1] * (3 if drive == "omni_angular" else 2)


def plaza(
    avoid: str = "[talk]",
    drive: str = "diff",
    planner: str = "astar",
    local: str = "{name: orca, safe_radius: 0.3}",
    state: str = "[6, 1.5, 1.57]",
    goal: str = "[6, 10.5]",
) -> str:
    keys = {"avoid": avoid, "drive": drive, "planner": planner, "local": local, "state": state, "goal": goal}
    return PLAZA.format(**keys, limits=limits(drive))


def corridor(
    within: str = "{rectangle: [2, 5, 18, 7]}", middle: float = 7.0, drive: str = "diff", planner: str = "astar"
) -> str:
    """The middle of the board that closes it: at 7.0 it leaves 0.9 m at the lower wall."""
    within = within and f", within: {within}"
    return CORRIDOR.format(drive=drive, within=within, middle=middle, planner=planner, limits=limits(drive))


def track_of(env: Any, steps: int = 500) -> Any:
    env.rollout(steps)
    return np.array(env.simulation.state.trajectory(env.robot.row))[:, :2]


def to_the_middle(track: Any) -> Any:
    return np.hypot(track[:, 0] - 6, track[:, 1] - 6)


def problems(text: str) -> list[tuple[str, str]]:
    return [(f.severity, f.code) for f in irsim.validate(text=text).findings if f.severity != "hint"]


# avoid
def test_without_the_key_the_path_leads_through_the_zone(make: Make) -> None:
    env = make(plaza(avoid="[]"))
    assert to_the_middle(track_of(env)).min() < ZONE_RADIUS
    assert env.robot.arrive


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(plaza(drive=drive, planner=planner, local=local), id=f"{drive}-{planner}-{local}")
        for drive in DRIVES
        for planner in ("astar", "jps", "prm", "rrt")
        for local in ("dash", "orca")
    ]
    + [pytest.param(plaza(drive="omni") + PEOPLE, id="others come towards it")],
)
def test_the_body_stays_out_of_the_zone(make: Make, text: str) -> None:
    env = make(text)
    assert to_the_middle(track_of(env)).min() > ZONE_RADIUS + RADIUS
    assert env.robot.arrive


def test_one_that_starts_in_a_zone_leaves_it_by_the_nearest_side(make: Make) -> None:
    env = make(plaza("[desk]", state="[9.5, 8.3, 0]"))
    track = track_of(env)
    assert env.robot.arrive
    inside = (track[:, 0] > 8) & (track[:, 1] > 8)
    assert inside.any()
    assert track[inside, 1].max() < 8.4
    assert not inside[np.flatnonzero(inside).max() + 1 :].any()


@pytest.mark.parametrize(
    ("text", "place"),
    [(plaza("[desk]", goal="[10, 7]"), [9.5, 8.2, 0]), (corridor(drive="omni"), [2.5, 4.2, 0])],
    ids=["into a zone", "out of its region"],
)
def test_one_that_was_pushed_away_goes_on_to_its_goal(make: Make, text: str, place: list[float]) -> None:
    env = make(text)
    take_steps(env, 15)
    env.robot.set_state(place)
    take_steps(env, 400)
    assert env.robot.arrive


def test_a_line_is_not_crossed(make: Make) -> None:
    env = make(plaza("[door, talk]", state="[5, 1.5, 1.57]"))
    track = track_of(env)
    assert env.robot.arrive
    on_line = np.abs(track[:, 1] - 3) < RADIUS
    assert ((track[on_line, 0] < 1 - RADIUS) | (track[on_line, 0] > 11 + RADIUS)).all()


def test_a_goal_in_an_avoided_zone_has_no_path(make: Make) -> None:
    env = make(plaza("[desk]", goal="[9.5, 9.5]"))
    track_of(env, 50)
    assert [event.kind for event in env.events] == ["no_path"]


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({}, []),
        ({"avoid": "[tolk]"}, [("error", "unknown-zone")]),
        ({"avoid": "[desk]", "goal": "[9.5, 9.5]"}, [("warning", "ends-in-zone")]),
        ({"avoid": "[desk]", "goal": "[7.8, 9.5]"}, [("warning", "ends-in-zone")]),
        ({"avoid": "[desk]", "goal": "[7.7, 9.5]"}, []),
        ({"avoid": "[talk]", "state": "[6, 6, 0]"}, [("warning", "ends-in-zone")]),
        ({"avoid": "[door]", "goal": "[6, 3.1]"}, [("warning", "ends-in-zone")]),
    ],
)
def test_avoided_zones_are_checked(keys: dict[str, str], expected: list[tuple[str, str]]) -> None:
    assert problems(plaza(**keys))[:1] == expected


def test_a_misspelled_zone_is_repaired() -> None:
    [finding] = [f for f in irsim.validate(text=plaza("[tolk]")).findings if f.code == "unknown-zone"]
    assert "talk" in (finding.fix or "")


def test_the_result_names_the_robot_that_entered_a_zone() -> None:
    through, around = irsim.run(text=plaza("[]"), seed=1), irsim.run(text=plaza(), seed=1)
    assert "'scout'" in through.summary
    assert through.zones["talk"].names == ["scout"]
    assert around.zones["talk"].objects == 0


def test_the_result_names_a_robot_that_was_in_a_zone_after_somebody_else() -> None:
    result = irsim.run(text=plaza("[]", goal="[9, 9.5]") + VISITOR, seed=1)
    assert result.zones["desk"].names == ["anna", "scout"]
    assert result.zones["desk"].robots == ["scout"]
    assert "first 'anna' at" in result.summary
    assert "the robot 'scout' later" in result.summary


def test_a_dry_run_names_the_robot_that_entered_a_zone() -> None:
    through, around = (irsim.validate(text=plaza(avoid), simulate=True).dry_run for avoid in ("[]", "[talk]"))
    assert "'talk': 1 object" in through.summary
    assert "first 'scout' at" in through.summary
    assert "nothing was in 'talk'" in around.summary


# within
def test_without_a_region_the_path_goes_around_through_the_open_ends(make: Make) -> None:
    env = make(corridor("", middle=6.0))
    assert np.abs(track_of(env)[:, 1] - 6).max() > 1, "outside the corridor"
    assert env.robot.arrive


def test_a_path_within_a_region_does_not_leave_it(make: Make) -> None:
    env = make(corridor(middle=6.0))
    track = track_of(env, 50)
    assert [event.kind for event in env.events] == ["no_path"]
    assert len(track) == 0 or (track == [3, 6]).all()


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("planner", ["astar", "jps"])
def test_where_there_is_a_way_inside_it_is_taken(make: Make, drive: str, planner: str) -> None:
    env = make(corridor(drive=drive, planner=planner))
    assert (np.abs(track_of(env)[:, 1] - 6) < 1).all()
    assert env.robot.arrive


@pytest.mark.parametrize("planner", ["rrt", "rrt_star", "informed_rrt_star", "prm"])
def test_planners_that_draw_samples_stay_inside(make: Make, planner: str) -> None:
    env = make(corridor(drive="omni", planner=planner))
    assert (np.abs(track_of(env)[:, 1] - 6) < 1).all()
    assert env.robot.arrive or "no_path" in [event.kind for event in env.events]


def test_a_polygon_with_a_notch_is_kept(make: Make) -> None:
    env = make("""
world: {width: 10, height: 10}
robot: {kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0], goal: [9, 1],
  behavior: {name: follow, within: {polygon: [[0, 0], [4, 0], [4, 6], [6, 6], [6, 0], [10, 0], [10, 8], [0, 8]]}}}
""")
    track = track_of(env)
    assert env.robot.arrive
    notch = (track[:, 0] > 4.0) & (track[:, 0] < 6.0)
    assert notch.any()
    assert (track[notch, 1] > 6.0).all()


@pytest.mark.parametrize(
    ("within", "expected"),
    [
        ("{rectangle: [2, 5, 18, 7]}", []),
        ("{rectangle: [2, 5, 16, 7]}", [("warning", "region-left")]),
        ("{rectangle: [18, 5, 2, 7]}", [("error", "range-order")]),
        ("{polygon: [[0, 0], [20, 12], [20, 0], [0, 12]]}", [("error", "invalid-polygon")]),
        ("{}", [("error", "missing-key")]),
        ("{rectangle: [2, 5, 18, 7], polygon: [[0, 0], [20, 0], [20, 12]]}", [("error", "conflicting-keys")]),
    ],
)
def test_regions_are_checked(within: str, expected: list[tuple[str, str]]) -> None:
    assert problems(corridor(within))[:1] == expected
