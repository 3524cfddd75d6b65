"""``irsim.run`` from a text, within limits, and what it says about why a run failed."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.benchmarks import BenchmarkError
from irsim.bundled import templates
from irsim.cli.app import app
from irsim.diagnostics.errors import OverLimitError, ScenarioError
from irsim.runs import open_run
from irsim.runs.inspection import inspect_run
from irsim.runs.resimulation import resimulate
from irsim.scenario.limits import Limits

ROBOT = """\
world: {width: 20, height: 6%s}
robot:
  - {name: rover, kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 3], goal: [%g, 3]%s}
"""
DASH = ", behavior: {name: dash}"


def text(goal: float = 4, extra: str = DASH, world: str = "") -> str:
    return ROBOT % (world, goal, extra)


def test_a_text_runs_like_a_file(tmp_path: Path) -> None:
    path = tmp_path / "room.yaml"
    path.write_text(text(), encoding="utf-8")
    from_file, from_text = irsim.run(path, seed=3), irsim.run(text=text(), seed=3)
    assert from_text.outcome == "success"
    assert from_text.robots == from_file.robots
    assert from_text.scenario == "(text)"
    assert from_text.reproduce.endswith("--seed 3  # the text, saved as scenario.yaml")


def test_exactly_one_of_path_and_text() -> None:
    with pytest.raises(ValueError, match="either a path or a text"):
        irsim.run()
    with pytest.raises(ValueError, match="either a path or a text"):
        irsim.run("room.yaml", text=text())


def test_success_needs_no_reason() -> None:
    assert irsim.run(text=text()).reason is None


@pytest.mark.parametrize("heading", [3.1, -3.1, 3.1 - 4 * np.pi])
def test_the_error_of_a_heading_goes_the_short_way(heading: float) -> None:
    arrives = ", goal_threshold: 0.01, arrive_mode: state"
    scene = text(extra=DASH + arrives).replace("[1, 3]", f"[1, 3, {heading}]").replace("[4, 3]", "[4, 3, -3]")
    [robot] = irsim.run(text=scene, steps=0).robots
    assert robot.heading_error == pytest.approx(abs(np.angle(np.exp(1j * (heading + 3)))))


def test_who_leaves_the_world_is_told_wherever_it_goes(tmp_path: Path) -> None:
    """Though it arrives, and also when it comes back: when, who, and what would keep it in."""

    def room(goal: float, world: str = "") -> str:
        return text(goal, world=world).replace("[1, 3]", "[1.05, 3]")

    told = "'rover' left the world at 19 s ('world.boundary: walls' would keep it in)"
    out = irsim.run(text=room(25), record=tmp_path / "run")
    assert out.outcome == "success"
    assert told in out.summary
    assert [(item.name, item.x) for item in out.left] == [("rover", pytest.approx(20.05))]
    assert told in inspect_run(open_run(tmp_path / "run")).summary
    there_and_back = irsim.run(text=room(4).replace("goal: [4, 3]", "waypoints: [[22, 3], [18, 3]]"))
    assert told in there_and_back.summary
    walled = irsim.run(text=room(25, world=", boundary: walls"))
    assert (walled.outcome, walled.left) == ("collision", [])
    assert irsim.run(text=room(15)).left == []
    scout = f"  - {{name: scout, kinematics: {{name: diff}}, state: [1, 1], goal: [30, 1]{DASH}}}\n"
    several = irsim.run(text=room(25) + scout)
    assert "'rover' left the world at 19 s and 1 more after it" in several.summary
    assert [item.name for item in several.left] == ["rover", "scout"]


def test_what_starts_outside_has_not_left() -> None:
    outside = irsim.run(text=text(4).replace("state: [1, 3]", "state: [-2, 3]"))
    assert outside.left == []
    assert "left the world" not in outside.summary


@pytest.mark.parametrize(
    ("scenario", "reason"),
    [
        (text(extra=""), "'rover' has no behavior, so it stands still 3.00 m from its goal"),
        (
            text(19, world=", time_limit: 5"),
            "at the time limit of 5 s (world.time_limit) 'rover' still moved at 1 m/s, 13.00 m from",
        ),
        (text() + "obstacle:\n  - {name: crate, state: [2.5, 3], shape: {name: circle}}\n", "'rover' hit 'crate' at "),
        ("world: {width: 5}\n", "there are no robots"),
    ],
)
def test_failures_say_why(scenario: str, reason: str) -> None:
    said = irsim.run(text=scenario).reason
    assert said is not None
    assert reason in said


def test_a_run_that_a_collision_ended_does_not_name_the_time_limit() -> None:
    late = f"robot:\n  - {{name: late, kinematics: {{name: diff}}, state: [1, 1], goal: [30, 1]{DASH}}}\n"
    crate = "obstacle:\n  - {name: crate, state: [2.5, 3], shape: {name: circle}}\n"
    scene = text(19, world=", time_limit: 5").replace("robot:\n", late) + crate
    ended = irsim.run(text=scene, until="first_collision")
    assert ended.reason is not None
    assert "'rover' hit 'crate' at " in ended.reason
    assert f"at {ended.sim_time:g} s, when the run ended (until: first_collision), 'late' still moved" in ended.reason
    assert "at the time limit of 5 s (world.time_limit) 'late' still moved" in str(irsim.run(text=scene).reason)


CROSSER = """\
obstacle:
  - {kinematics: {name: omni}, state: [1, 1, 0], goal: [3, 1, 0], vel_max: [1, 1], behavior: {name: dash}}
"""


def test_a_run_of_nobody_ends_when_all_that_moves_has_arrived() -> None:
    box = "obstacle: [{state: [3, 3], shape: {name: circle}}]\n"
    empty = irsim.run(text=f"world: {{width: 5}}\n{box}")
    assert (empty.steps, empty.summary) == (0, "no robots, and nothing moves")
    assert irsim.validate(text=f"world: {{width: 5}}\n{box}", simulate=True).dry_run.summary == empty.summary
    crossing = irsim.run(text="world: {width: 5}\n" + CROSSER)
    arrived = [event.step for event in crossing.events if event.kind == "arrival"]
    assert arrived == [crossing.steps]
    assert "no robots; " in crossing.summary
    on = irsim.run(text="world: {width: 5, time_limit: 9}\n" + CROSSER, until="time_limit")
    assert on.sim_time == pytest.approx(9)
    assert irsim.run(text="world: {width: 5, time_limit: 0.3}\n", show=True).steps == 3  # its window is open
    loop = CROSSER.replace("name: dash", "name: dash, loop: true")
    assert irsim.run(text="world: {width: 5, time_limit: 9}\n" + loop).sim_time == pytest.approx(9)


def test_a_horizon_beyond_the_limit_is_cut_and_said() -> None:
    result = irsim.run(text=text(19, world=", time_limit: 100"), limits=Limits(steps=20))
    assert (result.steps, result.time_limit_from) == (20, "limits")
    assert "the maximum number of steps of one run here" in str(result.reason)
    assert "--steps 20" in result.reproduce


def test_more_steps_than_allowed_are_refused() -> None:
    with pytest.raises(OverLimitError, match=r"over-limit: 21 steps are too many.* ask for at most 20 steps"):
        irsim.run(text=text(), steps=21, limits=Limits(steps=20))
    with pytest.raises(OverLimitError, match="10 steps x objects are run at once, and there are 1 objects"):
        irsim.run(text=text(), steps=11, limits=Limits(work=10))


def test_robots_and_aliases_have_limits_of_their_own() -> None:
    many = "robot:\n  - {number: 11, kinematics: {name: diff}}\nobstacle:\n  - {number: 20, shape: {name: circle}}\n"
    for limits in (Limits(robots=10), Limits(objects=30)):
        with pytest.raises(ScenarioError, match="too-many-objects"):
            irsim.run(text=many, limits=limits)
    aliases = "custom: &a [1]\nrobot:\n  - {tags: *a}\n  - {tags: *a}\n"
    with pytest.raises(ScenarioError, match="more than 1 aliases"):
        irsim.run(text=aliases, limits=Limits(aliases=1))


def test_a_robot_that_left_the_world_is_said_to_be_outside() -> None:
    away = (
        text(4, DASH, ", time_limit: 3").replace("goal: [4, 3]", "goal: [-9, 3]").replace("[1, 3]", "[1, 3, 3.14159]")
    )
    assert "from its goal, outside the world at (-2.00, 3.00)" in str(irsim.run(text=away).reason)


def test_another_behavior_for_all_robots(tmp_path: Path) -> None:
    path = tmp_path / "room.yaml"
    path.write_text(text(extra=""), encoding="utf-8")
    assert irsim.run(path).outcome == "timeout"
    result = irsim.run(path, behavior="dash")
    assert (result.outcome, result.behavior) == ("success", "dash")
    assert result.summary.startswith("with behavior dash for all robots: ")
    assert result.reproduce == f"irsim run {path} --policy dash"
    again = CliRunner().invoke(app, [*shlex.split(result.reproduce)[1:], "--json"])
    assert json.loads(again.stdout) == result.model_dump(mode="json")
    assert not [item for item in result.warnings if item.code == "no-behavior"]


def test_a_behavior_with_options_and_one_that_nobody_has() -> None:
    result = irsim.run(text=text(), behavior={"name": "orca", "timeHorizon": 3})
    assert result.behavior == "{name: orca, timeHorizon: 3}"
    assert "--policy '{name: orca, timeHorizon: 3}'" in result.reproduce
    assert irsim.run(text=text(), behavior="as-written") == irsim.run(text=text())
    with pytest.raises(BenchmarkError, match=r"there is no policy 'orcaa'\. Fix: did you mean orca\?"):
        irsim.run(text=text(), behavior="orcaa")


def test_a_record_of_a_run_with_another_behavior_is_shown_as_it_was(tmp_path: Path) -> None:
    result = irsim.run(text=text(extra=""), behavior="dash", record=tmp_path / "run")
    run = open_run(tmp_path / "run")
    assert run.scenario_text == text(extra="")
    env = resimulate(run)
    try:
        assert env.robot.state[0, 0] == pytest.approx(result.robots[0].pose[0], abs=1e-12)
        assert env.robot.arrive
    finally:
        env.end(ending_time=0.0)


def test_no_seed_is_drawn_where_nothing_is_random() -> None:
    first, second = irsim.run(text=text()), irsim.run(text=text())
    assert first == second
    assert (first.seed, first.random) == (0, [])
    assert "--seed" not in first.reproduce
    noisy = text().replace("{name: diff}", "{name: diff, noise: true}")
    assert irsim.run(text=noisy).seed != irsim.run(text=noisy).seed
    assert "--seed" in irsim.run(text=noisy).reproduce


def test_success_says_when_the_last_one_arrived() -> None:
    result = irsim.run(text=text())
    assert result.summary == f"the robot arrived at {result.robots[0].time_to_goal:.10g} s"


def test_who_was_pushed_off_its_goal_is_said() -> None:
    aside = """\
world: {width: 10, height: 6, time_limit: 12}
robot:
  - {name: first, kinematics: {name: omni}, shape: {name: circle, radius: 0.4}, state: [5, 3.05], goal: [5, 3.05],
     behavior: {name: orca}, goal_threshold: 0.2}
  - {name: second, kinematics: {name: omni}, shape: {name: circle, radius: 0.4}, state: [1, 3], goal: [4.9, 3],
     behavior: {name: dash}}
"""
    result = irsim.run(text=aside)
    arrivals = [event.object for event in result.events if event.kind == "arrival"]
    assert arrivals == ["first", "second"]
    assert "2 of 2 robots arrived, the last at " in result.summary
    assert result.summary.endswith("; 'first' left its goal again")


def test_moving_obstacles_that_have_goals_are_counted() -> None:
    walkers = text(18) + "".join(
        f"  - {{kinematics: {{name: omni}}, shape: {{name: circle}}, state: {start}, goal: {goal}{DASH}}}\n"
        for start, goal in (("[15, 1]", "[15, 5]"), ("[3, 5]", "[19, 5]"))
    ).replace("  -", "obstacle:\n  -", 1)
    assert irsim.run(text=walkers, steps=70).summary.endswith("; 1 of 2 moving obstacles arrived")
    report = irsim.validate(text=walkers, simulate=True)
    assert report.dry_run is not None
    assert "of 2 moving obstacles arrived" in report.dry_run.summary


def test_what_a_robot_came_nearest_to() -> None:
    posts = "obstacle:\n  - {name: post, shape: {name: circle, radius: 0.5}, state: [3, 4.2]}\n"
    posts += "  - {name: beyond, shape: {name: circle, radius: 0.5}, state: [6, 3.9]}\n"
    [robot] = irsim.run(text=text(goal=4) + posts).robots
    assert (robot.nearest, robot.min_clearance) == ("post", pytest.approx(1.2 - 0.3 - 0.5, abs=1e-3))
    [alone] = irsim.run(text=text()).robots
    assert (alone.nearest, alone.min_clearance) == (None, None)
    [hit] = irsim.run(text=text(goal=6) + posts.replace("4.2", "3.2")).robots
    assert hit.nearest == "post"
    assert hit.min_clearance is not None
    assert hit.min_clearance <= 0


@pytest.mark.parametrize("name", ["circle-swap", "bottleneck", "mixed-fleet"])
def test_the_nearest_is_that_of_the_metrics(name: str) -> None:
    file = templates.scenario_file(name)
    result = irsim.run(file, seed=2, steps=100)
    [episode] = irsim.benchmark(str(file), seeds=[2], steps=100).episodes
    least = [robot.min_clearance for robot in result.robots if robot.min_clearance is not None]
    assert len(least) == len(result.robots)
    assert min(least) == pytest.approx(episode.metrics["min_clearance"])


def test_who_arrives_in_spite_of_a_collision_has_arrived() -> None:
    crossing = """\
world: {width: 12, height: 8, time_limit: 30, collision_mode: unobstructed}
robot:
  - {name: a, kinematics: {name: omni}, shape: {name: circle}, state: [1, 7], goal: [11, 7], behavior: {name: dash}}
  - {name: b, kinematics: {name: omni}, shape: {name: circle}, state: [11, 7], goal: [1, 7], behavior: {name: dash}}
  - {name: c, kinematics: {name: omni}, shape: {name: circle}, state: [1, 2], goal: [11, 2], behavior: {name: dash}}
"""
    result = irsim.run(text=crossing)
    assert result.outcome == "collision"
    assert result.summary.startswith("'a' hit 'b' at 4.9 s")
    assert result.summary.endswith("; 3 of 3 robots arrived, the last at 10 s, 2 of them after a collision")


TOUCHED = """
world: {width: 12, height: 8, time_limit: 6, collision_mode: MODE}
robot:
  - {name: a, kinematics: {name: omni}, shape: {name: circle}, state: [1, 7], goal: [11, 7], behavior: {name: dash}}
obstacle: {name: post, shape: {name: circle}, state: [4, 7.1]}
"""


@pytest.mark.parametrize(
    ("mode", "outcome"),
    [
        ("stop", "collision"),
        ("unobstructed_obstacles", "collision"),
        ("unobstructed", "timeout"),
        ("reactive", "timeout"),
    ],
)
def test_who_drives_on_after_a_contact_and_does_not_arrive_has_timed_out(mode: str, outcome: str) -> None:
    text = TOUCHED.replace("MODE", mode)
    result = irsim.run(text=text)
    assert (result.outcome, result.robots[0].outcome) == (outcome, outcome)
    assert result.robots[0].collision_count == 1
    assert "'a' hit 'post' at " in result.summary
    [episode] = irsim.benchmark(text).episodes
    assert episode.outcome == outcome
    assert (episode.metrics[outcome], episode.metrics["collision_count"]) == (1, 1)
    assert sum(episode.metrics[key] for key in ("success", "collision", "timeout")) == 1
    assert episode.failures == {"a": "timeout" if outcome == "timeout" else "collision with 'post'"}


STANDING = """
world: {width: 20, height: 12, time_limit: 30}
robot:
  - {kinematics: {name: diff}, shape: {name: circle}, state: [1, 1, 0], goal: [18, 1, 0], behavior: {name: dash}}
obstacle:
  - {name: trap, shape: {name: linestring, vertices: [[-3, 3], [0, 3], [0, -3], [-3, -3]]}, state: [8, 6, 0]}
  - name: hung
    kinematics: {name: omni}
    shape: {name: circle, radius: 0.3}
    state: [3, 6, 0]
    goal: [17, 6]
    behavior: {name: rvo}
"""


def test_moving_obstacles_that_stand_short_of_their_goal_are_said() -> None:
    result = irsim.run(text=STANDING)
    assert result.outcome == "success"
    assert "the moving obstacle 'hung' has stood still 9.45 m from its goal since 5.7 s" in result.summary
    other = "  - {name: more, kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [1.5, 8, 0], "
    two = irsim.run(text=STANDING + other + "goal: [17, 8], behavior: {name: rvo}}\n").summary
    assert "2 of 2 moving obstacles stand still short of their goals (first 'hung', 9.45 m" in two
    freed = irsim.run(text=STANDING.replace("[-3, 3], [0, 3], [0, -3], [-3, -3]", "[0, 3], [0, -3]"))
    assert "1 of 1 moving obstacle arrived" in freed.summary
    assert "stood still" not in freed.summary


UNDRIVEN = """
world: {width: 10, height: 10, time_limit: 2}
robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 1, 0], goal: [9, 9, 0]}
obstacle: {kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 9, 0], goal: [3, 9, 0]}
"""


def test_no_behavior_is_left_out_for_robots_that_a_policy_drives(tmp_path: Path) -> None:
    def still(observations: Any) -> Any:
        return np.zeros((len(observations), 2))

    def told(findings: list[Any]) -> list[str]:
        return [finding.path for finding in findings if finding.code == "no-behavior"]

    assert told(irsim.run(text=UNDRIVEN).warnings) == ["robot", "obstacle"]
    assert told(irsim.run(text=UNDRIVEN, policy=still).warnings) == ["obstacle"]
    assert told(irsim.run(text=UNDRIVEN, policy="dash").warnings) == ["obstacle"]
    file = tmp_path / "undriven.yaml"
    file.write_text(UNDRIVEN)
    for policies, expected in ((["dash", "orca"], ["obstacle"]), (["dash", "as-written"], ["robot", "obstacle"])):
        [warnings] = irsim.benchmark(file, policies=policies, seeds=1, workers=1).warnings.values()
        assert told(warnings) == expected
