"""The dry run: what happens in the first steps, and why nothing happens."""

from __future__ import annotations

import time
from typing import Any

import pytest

import irsim
from irsim.bundled.templates import scenario_file
from irsim.common.text import seconds
from irsim.scenario.limits import Limits
from irsim.scenario.open import read_scenario
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.validation.dry_run import dry_run

ROBOT = """\
  - name: rover
    kinematics: {{name: diff}}
    shape: {{name: circle, radius: 0.3}}
    state: {state}
    goal: {goal}
    vel_max: [1, 1.5]
    vel_min: [-1, -1.5]
    {more}
"""


def looked(text: str, **options: Any) -> irsim.results.validation.DryRun:
    """The dry run of a scenario that is valid."""
    report = irsim.validate(text=text, simulate=True, **options)
    assert report.dry_run is not None, report.findings
    return report.dry_run


def tried(
    *,
    state: str = "[1, 4, 0]",
    goal: str = "[9, 4]",
    more: str = "behavior: {name: dash}",
    world: str = "{width: 10, height: 8}",
    obstacle: str = "",
) -> irsim.results.validation.DryRun:
    text = f"world: {world}\nrobot:\n" + ROBOT.format(state=state, goal=goal, more=more)
    if obstacle:
        text += f"obstacle:\n  - {obstacle}\n"
    return looked(text)


def test_tells_who_arrived() -> None:
    outcome = tried()
    assert (outcome.arrived, outcome.ended) == (["rover"], "done")
    assert (outcome.collisions, outcome.stuck, outcome.left) == ([], [], [])
    assert outcome.sim_time == pytest.approx(8.0, abs=0.3)  # 8 m at 1 m/s
    assert "1 of 1 robots arrived" in outcome.summary


def test_tells_who_hit_whom_when_and_where() -> None:
    outcome = tried(obstacle="{name: pillar, shape: {name: circle, radius: 0.5}, state: [5, 4, 0]}")
    hit = outcome.collisions[0]
    assert {hit.object, hit.partner} == {"rover", "pillar"}
    assert hit.time == pytest.approx(3.2, abs=0.2)  # 4 m less both radii
    assert hit.x == pytest.approx(4.5, abs=0.2)
    assert "pillar" in outcome.summary


@pytest.mark.parametrize(
    ("settings", "why"),
    [
        ({"more": "color: red"}, "no behavior"),
        (
            {
                "more": "behavior: {name: follow}",
                "obstacle": "{shape: {name: linestring, vertices: [[5, -1], [5, 9]]}, state: [0, 0, 0]}",
            },
            "path",
        ),
    ],
)
def test_tells_why_a_robot_is_stuck(settings: dict[str, str], why: str) -> None:
    outcome = tried(**settings)
    assert [item.name for item in outcome.stuck] == ["rover"]
    assert why in outcome.stuck[0].why
    assert outcome.stuck[0].since == pytest.approx(0.0, abs=0.5)
    assert (outcome.stuck[0].x, outcome.stuck[0].y) == pytest.approx((1, 4), abs=0.2)


def test_tells_who_left_the_world() -> None:
    outcome = tried(state="[1.05, 4, 0]", goal="[20, 4]")
    assert [item.name for item in outcome.left] == ["rover"]
    assert outcome.left[0].time == pytest.approx(9.0, abs=0.3)
    assert "'rover' left the world at 9 s ('world.boundary: walls' would keep it in)" in outcome.summary
    assert tried(goal="[20, 4]", world="{width: 10, height: 8, boundary: walls}").left == []


def test_is_the_same_every_time_and_ends_within_its_budget() -> None:
    assert tried() == tried()
    crowd = looked(
        "world: {width: 60, height: 60, time_limit: 100000}\n"
        "robot: {number: 300, distribution: {name: random, range_low: [1, 1, -3], range_high: [59, 59, 3]},"
        " kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, behavior: {name: orca, wander: true}}\n"
    )
    assert (crowd.ended, crowd.steps) == ("budget", 1000)


SCANNER = """\
world: {width: 10000, height: 10000}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [1, 1, 0]
  goal: [9000, 9000]
  behavior: {name: dash}
  sensors: [{name: lidar2d, number: 20000, range_max: 100}]
"""


def steps_of(scenario: ResolvedScenario) -> int:
    return dry_run(scenario, seed=1, budget=30_000, seconds=60).steps


CROWD = """\
world: {{width: 60, height: 60, time_limit: 100000, collision_mode: unobstructed}}
robot:
  - number: 100
    distribution: {{name: random, range_low: [1, 1, -3], range_high: [59, 59, 3]}}
    kinematics: {{name: omni}}
    shape: {{name: circle, radius: 0.2}}
    behavior: {{name: {behavior}, wander: true}}
    sensors: [{sensor}]
"""


def test_what_is_tried_does_not_depend_on_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    scenario, _ = read_scenario(text=CROWD.format(behavior="sfm", sensor="{name: lidar2d, number: 360}"), strict=True)
    begin = time.monotonic()
    outcome = dry_run(scenario, seed=1, budget=30_000)
    assert time.monotonic() - begin < 5
    assert outcome.ended == "budget"
    monkeypatch.setattr("irsim.validation.dry_run._CLOCK_PERIOD_S", 1e-6)  # as on a machine that is far slower
    assert dry_run(scenario, seed=1, budget=30_000) == outcome


@pytest.mark.parametrize(
    ("behavior", "sensor"),
    [
        ("dash", "{name: lidar2d, number: 100}"),
        ("dash", "{name: lidar2d, number: 1000, range_max: 20, noise: true}"),
        ("sfm", ""),
        ("rvo", ""),
        ("follow", ""),
    ],
)
def test_what_costs_more_gets_fewer_steps(behavior: str, sensor: str) -> None:
    plain, _ = read_scenario(text=CROWD.format(behavior="dash", sensor=""), strict=True)
    costly, _ = read_scenario(text=CROWD.format(behavior=behavior, sensor=sensor), strict=True)
    assert steps_of(plain) == 300  # one unit each
    assert 1 <= steps_of(costly) < 290


def test_plans_that_come_again_cost() -> None:
    pillar = "obstacle: {shape: {name: circle, radius: 2}, state: [30, 30, 0]}\n"
    once, _ = read_scenario(text=CROWD.format(behavior="follow", sensor="") + pillar, strict=True)
    often, _ = read_scenario(text=CROWD.format(behavior="follow, replan: 0.1", sensor="") + pillar, strict=True)
    assert steps_of(often) < 0.2 * steps_of(once)


def test_a_robot_alone_with_many_beams_goes_all_the_way() -> None:
    scenario, _ = read_scenario(text=SCANNER, strict=True)
    assert dry_run(scenario, steps=500).steps == 500
    assert dry_run(scenario, budget=2100, seconds=60).steps < 100  # 20 for the beams at least


def test_the_clock_is_the_last_resort_and_told() -> None:
    scenario, _ = read_scenario(text=SCANNER, strict=True)
    cut = dry_run(scenario, budget=10**9, seconds=0.1)
    assert (cut.ended, cut.arrived) == ("budget", [])
    assert 1 < cut.steps < 100_000
    assert cut.summary.startswith(
        f"in the first {seconds(cut.sim_time)} only, after which 0.1 s of computing time were used up"
    )
    assert "computing" not in dry_run(scenario, budget=1000).summary


def test_how_often_it_looks_at_the_clock_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    scenario, _ = read_scenario(scenario_file("circle-swap"), strict=True)
    outcome = dry_run(scenario)
    monkeypatch.setattr("irsim.validation.dry_run._CLOCK_PERIOD_S", 0.0)  # after each step
    assert dry_run(scenario) == outcome


def test_a_world_without_objects_is_tried_too() -> None:
    assert "no robots" in looked("world: {width: 10, height: 8, time_limit: 5}\n").summary


def test_a_seed_without_room_is_a_finding() -> None:
    report = irsim.validate(
        text="world: {width: 6, height: 6}\n"
        "robot: {number: 27, distribution: {name: random, range_low: [0, 0, -3], range_high: [6, 6, 3]},"
        " kinematics: {name: omni}, shape: {name: circle, radius: 0.5}, behavior: {name: dash}}\n",
        simulate=True,
        seed=0,
    )
    assert report.dry_run is None
    assert not report.valid
    assert report.findings[0].code == "placement-crowded"


def test_without_a_seed_the_first_one_with_room_is_tried_and_the_others_are_named() -> None:
    report = irsim.validate(text=TIGHT, simulate=True)
    assert report.valid
    assert report.dry_run is not None
    assert report.dry_run.seed == 5
    assert "seeds 0, 1, 2, 3, 4 had no room (placement-crowded)" in report.dry_run.summary
    [tight] = [item for item in report.findings if item.code == "placement-tight"]
    assert "(0, 1, 2, 3, 4 and 9 more)" in tight.message


TIGHT = """
world: {width: 6, height: 6}
robot:
  - {number: 5, kinematics: {name: diff}, shape: {name: circle, radius: 0.55}, behavior: {name: dash},
     distribution: {name: random, range_low: [1, 1, 0], range_high: [5, 5, 0], min_distance: 2.0}}
"""


PEOPLE = """\
world: {width: 12, height: 8, time_limit: 20}
robot:
  - {name: r, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 7.4], goal: [11, 7.4],
     behavior: {name: dash}}
obstacle:
  - {name: [east, west], number: 2, distribution: {name: manual}, kinematics: {name: omni},
     shape: {name: circle, radius: 0.3}, state: [[1, 3, 0], [11, 3, 0]], goal: [[11, 3, 0], [1, 3, 0]],
     behavior: {name: dash}}
"""


def test_people_who_stand_since_they_met_are_counted_though_all_robots_arrived() -> None:
    dry = looked(PEOPLE)
    told = "2 of 2 moving obstacles were stopped by a collision ('east' hit 'west' at "
    assert dry.jammed == ["east", "west"]
    assert told in dry.summary
    result = irsim.run(text=PEOPLE)
    assert (result.outcome, result.jammed) == ("success", ["east", "west"])
    assert told in result.summary
    passing = irsim.run(text=PEOPLE.replace("20}", "20, collision_mode: unobstructed_obstacles}", 1))
    assert passing.jammed == []
    assert "stopped by a collision" not in passing.summary


def test_a_robot_that_stands_before_them_is_told_that_they_stand_since_a_collision() -> None:
    blocked = """\
world: {width: 12, height: 8, time_limit: 30}
robot:
  - {name: r, kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [6, 7], goal: [6, 1],
     behavior: {name: orca}}
obstacle:
  - {name: [a, b], number: 2, distribution: {name: manual}, kinematics: {name: omni},
     shape: {name: rectangle, length: 6, width: 0.5}, state: [[2.4, 4, 0], [9.6, 4, 0]], goal: [[9, 4, 0], [1, 4, 0]],
     behavior: {name: dash}}
"""
    for why in (looked(blocked).stuck[0].why, str(irsim.run(text=blocked).reason)):
        assert "m from it and has been stopped since a collision at " in why


def test_more_robots_that_stand_than_are_listed_are_counted() -> None:
    robot = (
        "  - {{kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, state: [{x}, 2, 0], goal: [{x}, 8],"
        " behavior: {{name: dash}}, vel_max: [0, 0], vel_min: [0, 0]}}\n"
    )
    many = "world: {width: 40, height: 10, time_limit: 10}\nrobot:\n"
    many += "".join(robot.format(x=x) for x in range(1, 26))
    dry = looked(many)
    assert len(dry.stuck) == 10
    assert "; 24 more make no progress" in dry.summary


def test_a_slow_robot_does_not_stand_and_a_cut_look_says_so() -> None:
    text = """\
world: {width: 10, height: 8, time_limit: 60}
robot:
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 4, 0], goal: [9, 4],
     vel_max: [0.001, 1], behavior: {name: dash}}
"""
    outcome = looked(text, limits=Limits(steps=100))
    assert (outcome.ended, outcome.stuck) == ("budget", [])
    assert outcome.summary.startswith("in the first 10 s only: ")
    assert "still moved at 0.001 m/s" in str(irsim.run(text=text, steps=50).reason)


def test_a_robot_that_circles_its_goal_is_told_so() -> None:
    car = """\
world: {width: 12, height: 12, time_limit: 60}
robot:
  - {name: car, kinematics: {name: acker}, shape: {name: rectangle, length: 1, width: 0.5, wheelbase: 0.8},
     state: [6, 6, 0, 0], goal: [6, 7.2, 0], goal_threshold: 0.1, vel_min: [0, -0.5], vel_max: [1, 0.5],
     behavior: {name: dash}}
"""
    dry = looked(car)
    [stuck] = dry.stuck
    assert stuck.doing == "circles its goal"
    assert "raise goal_threshold" in stuck.why
    assert "'car' circles its goal since" in dry.summary
    result = irsim.run(text=car)
    assert "'car' circles its goal: radius 1.5 m, on these circles never nearer than 1.16 m" in str(result.reason)
    assert irsim.run(text=car.replace("goal_threshold: 0.1", "goal_threshold: 1.3")).outcome == "success"


def test_what_cannot_move_and_has_no_goal_written_is_parked() -> None:
    watcher = """\
world: {width: 10, height: 10, time_limit: 2}
robot:
  - {name: watcher, shape: {name: circle, radius: 0.2}, state: [1, 5]}
"""
    dry = looked(watcher)
    assert (dry.parked, dry.stuck) == (["watcher"], [])
    assert "1 is parked" in dry.summary
    result = irsim.run(text=watcher)
    assert str(result.reason).startswith(
        "'watcher' is parked (cannot move, no goal written); the run ended at the time limit of 2 s"
    )
    assert result.robots[0].distance_to_goal is None
    assert irsim.api.snapshot(text=watcher).robots[0].goal is None
    aimed = irsim.run(text=watcher.replace("[1, 5]}", "[1, 5], goal: [1, 9]}"))
    assert (aimed.parked, aimed.robots[0].distance_to_goal) == ([], pytest.approx(4))


def test_no_distance_is_told_to_a_goal_that_nobody_wrote() -> None:
    idle = "robot:\n  - {name: r, kinematics: {name: diff}, state: [1, 5]}\n"
    told = str(irsim.run(text=idle, steps=10).reason)
    assert told.endswith("'r' has no behavior, so it stands still; no goal is written for it")
