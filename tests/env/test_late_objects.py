"""`appear_time`: objects that come into the world after its start; `start_time`: objects that begin to move later."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.metrics import episode_metrics
from irsim.objects.drawing.scene_builder import SceneBuilder
from irsim.rendering.snapshot import legible_scene
from irsim.runs import open_run
from irsim.runs.replay.data import pack_run
from irsim.simulation.trace import record
from tests.env.driving import Make, take_steps

SHAPES = {
    "circle": "{name: circle, radius: 0.4}",
    "rectangle": "{name: rectangle, length: 0.8, width: 0.8}",
    "polygon": "{name: polygon, vertices: [[-0.4, -0.4], [0.4, -0.4], [0.4, 0.4], [-0.4, 0.4]]}",
    "linestring": "{name: linestring, vertices: [[-0.4, -1], [-0.4, 1]]}",
    "compound": "{name: compound, parts: [{name: rectangle, length: 0.8, width: 0.8}, {name: circle, radius: 0.1}]}",
}
APPEAR = """
world: {width: 10, height: 10, step_time: 0.1, time_limit: 30}
robot:
  - {name: first, state: [1, 1, 0], goal: [9, 1], kinematics: {name: diff}, shape: {name: circle, radius: 0.2},
     behavior: {name: dash}}
  - {name: late, state: [1, 3, 0], goal: [9, 3], kinematics: {name: diff}, shape: {name: circle, radius: 0.2},
     behavior: {name: dash}, appear_time: 1.0, sensors: [{name: lidar2d, number: 3}]}
obstacle:
  - {name: crate, state: [5, 6, 0], shape: {name: rectangle, length: 0.5, width: 0.5}, appear_time: 2}
  - {name: walker, kinematics: {name: omni}, state: [1, 3, 0], goal: [1, 9], tags: [pedestrian],
     shape: {name: rectangle, length: 0.3, width: 0.3}, behavior: {name: dash}, appear_time: 1.0}
"""
START = """
world: {width: 10, height: 10, step_time: 0.1}
robot:
  - {number: 3, state: [[1, 1, 0], [1, 3, 0], [1, 5, 0]], goal: [[9, 1], [9, 3], [9, 5]], kinematics: {name: diff},
     shape: {name: circle, radius: 0.2}, behavior: {name: dash}, velocity: [0.5, 0], start_time: [0, 1.0, 2.55]}
obstacle:
  - {kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [1, 8, 0], goal: [9, 8],
     behavior: {name: dash}, start_time: 0.3}
"""
NEVER = APPEAR.replace("appear_time: 1.0, sensors", "appear_time: 100, sensors")


def positions(env: Any) -> Any:
    return np.array(env.simulation.pose)[:, :2]


def messages(text: str, code: str) -> list[str]:
    """Messages of `irsim validate` with a code."""
    return [finding.message for finding in irsim.validate(text=text).findings if finding.code == code]


# both
@pytest.mark.parametrize("text", [APPEAR, START], ids=["appear", "start"])
def test_batches_rollouts_and_python_steps_equal_single_steps(make: Make, text: str) -> None:
    env, python, rollout = make(text), make(text), make(text).rollout(40, until_done=False)
    batch = irsim.batch(env.scenario, 2, seeds=[0, 1])
    python.simulation.decisions.append(lambda simulation: None)
    for step in range(40):
        env.step()
        batch.step()
        python.step()
        row = np.asarray(rollout.pose)[step + 1 - (len(rollout.pose) == 40)]
        for other in (row, np.array(batch.pose[1]), np.array(python.simulation.pose)):
            np.testing.assert_array_equal(np.array(env.simulation.pose), other)


@pytest.mark.parametrize(("text", "name"), [(APPEAR, "late"), (START, "robot_1")], ids=["appear", "start"])
def test_commands_do_not_move_an_object_before_its_time(make: Make, text: str, name: str) -> None:
    env = make(text)
    take_steps(env, 10, {name: [1.0, 0.0]})
    assert env.get_object_by_name(name).state[:, 0].tolist() == [1, 3, 0]
    env.step({name: [1.0, 0.0]})
    assert env.get_object_by_name(name).state[0, 0] == pytest.approx(1.1)


@pytest.mark.parametrize(
    ("text", "key", "written"),
    [(APPEAR, "appear_time: 2", "spawn_time: 2"), (START, "start_time: 0.3", "delay: 0.3")],
    ids=["appear", "start"],
)
def test_delays_by_other_names_lead_to_the_key(text: str, key: str, written: str) -> None:
    findings = irsim.validate(text=text.replace(key, written)).findings
    assert any(key.partition(":")[0] in str(f.fix) for f in findings if f.code == "unknown-key")


@pytest.mark.parametrize(
    "text", [NEVER.replace(", time_limit: 30", ""), START.replace("2.55", "100")], ids=["appear", "start"]
)
def test_the_default_time_limit_counts_from_the_time_of_each_object(text: str) -> None:
    assert irsim.run(text=text).outcome == "success"


# appear_time
@pytest.mark.parametrize("mode", ["stop", "contact"])
@pytest.mark.parametrize("drive", ["", "kinematics: {name: omni}, "])
@pytest.mark.parametrize("shape", SHAPES)
def test_an_object_is_neither_sensed_nor_touched_before_it_appears(
    make: Make, shape: str, drive: str, mode: str
) -> None:
    env = make(f"""
world: {{width: 10, height: 10, step_time: 0.1, collision_mode: {mode}}}
robot:
  - {{state: [2, 5, 0], goal: [9, 5], kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}},
     behavior: {{name: dash}}, sensors: [{{name: lidar2d, number: 1, range_max: 20}}]}}
obstacle:
  - {{{drive}state: [4, 5, 0], shape: {SHAPES[shape]}, appear_time: 5}}
  - {{{drive}state: [8, 5, 0], shape: {SHAPES[shape]}, appear_time: 3}}
""")
    robot = env.robot
    for _ in range(29):
        env.step()
        assert robot.lidar.range_data[0] == 20
    env.step()
    assert robot.lidar.range_data[0] == pytest.approx(2.6, abs=0.1)
    assert robot.state[0, 0] == pytest.approx(5, abs=0.1), "it drove through the place of the object that comes later"
    assert not robot.collision
    take_steps(env, 30)
    assert robot.collision if mode == "stop" else robot.state[0, 0] < 7.7 or positions(env)[2, 0] > 8


def test_its_position_is_undefined_and_its_lidar_measures_nothing_until_then(make: Make) -> None:
    env = make(APPEAR)
    late = env.get_object_by_name("late")
    assert np.isnan(late.state[:2, 0]).all()
    assert late.lidar.range_data.tolist() == [10] * 3
    take_steps(env, 11)
    assert late.state[0, 0] == pytest.approx(1.1)
    env.reset()
    assert np.isnan(late.state[:2, 0]).all()


def test_whose_place_is_taken_waits_until_there_is_room(make: Make) -> None:
    env = make(APPEAR)
    for _ in range(13):
        env.step()
        assert np.isnan(positions(env)[3]).all(), "the robot 'late' appeared in the same place"
    env.step()
    assert positions(env)[3].tolist() == [1, 3]
    assert not any(view.collision for view in env.objects)
    assert "'walker' appeared 0.4 s late, when there was room at its start" in irsim.run(text=APPEAR).summary


def test_the_summary_names_who_never_appeared() -> None:
    result = irsim.run(text=APPEAR.replace("appear_time: 2", "appear_time: 20"), steps=5)
    assert "'late' did not appear (it appears at 1 s)" in result.summary
    assert "'crate' did not appear (it appears at 20 s)" in result.summary
    assert "'late' is not in the world yet, 8.00 m from its goal (it appears at 1 s)" in str(result.reason)
    json.loads(result.model_dump_json())
    text = APPEAR.replace("state: [5, 6, 0]", "state: [9, 1, 0]").replace("appear_time: 2", "appear_time: 9")
    no_room = "'crate' did not appear (since 9 s there has been no room for it at its start)"
    assert no_room in irsim.run(text=text, steps=200).summary


def test_followers_plan_anew_round_what_appears(make: Make) -> None:
    env = make("""
world: {width: 10, height: 10, step_time: 0.1}
robot:
  - {state: [1, 5, 0], goal: [9, 5], kinematics: {name: diff}, shape: {name: circle, radius: 0.2},
     behavior: {name: follow}}
obstacle:
  - {state: [6, 5, 0], shape: {name: rectangle, length: 0.4, width: 3}, appear_time: 1}
""")
    take_steps(env, 200)
    assert (env.robot.arrive, env.robot.collision) == (True, False)


@pytest.mark.parametrize("behavior", ["orca", "rvo", "sfm"])
def test_crowds_drive_straight_through_the_place_where_an_object_will_appear(make: Make, behavior: str) -> None:
    env = make(f"""
world: {{width: 10, height: 10, step_time: 0.1, collision_mode: unobstructed}}
robot:
  - {{state: [2, 5, 0], goal: [9, 5], kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.2}},
     behavior: {{name: {behavior}}}}}
obstacle:
  - {{state: [4, 5.1, 0], kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.3}}, appear_time: 60}}
  - {{state: [5, 5.1, 0], shape: {{name: linestring, vertices: [[0, -1], [0, 1]]}}, appear_time: 60}}
  - {{state: [6, 5.1, 0], shape: {{name: rectangle, length: 1, width: 1}}, appear_time: 60}}
  - {{state: [7, 5.1, 0], shape: {{name: circle, radius: 0.3}}, appear_time: 60}}
""")
    for _ in range(60):
        env.step()
        assert env.robot.state[1, 0] == pytest.approx(5, abs=1e-12)


def test_metrics_count_from_the_appearance_on_and_only_who_is_there(make: Make) -> None:
    def metrics_of(text: str, steps: int) -> list[Any]:
        env = make(text)
        return episode_metrics(record(env.simulation, steps, until_done=False), env.simulation, env.events).robots

    first, late = metrics_of(APPEAR, 150)
    assert late["path_length"] == pytest.approx(first["path_length"], abs=0.15)
    assert late["time_to_goal"] == pytest.approx(first["time_to_goal"] + 1, abs=0.15), "times count from the start"
    assert first["distance_to_human_min"] == pytest.approx(2.03, abs=0.1)
    assert np.isfinite([late["distance_to_human_min"], late["social_work"]]).all()
    assert late["pedestrian_velocity_avg"] == pytest.approx(0.8, abs=0.1)
    missing = metrics_of(NEVER, 60)[1]
    assert missing["success"] == 0
    assert np.isnan(missing["min_clearance"])


def test_a_recorded_run_knows_who_was_there(tmp_path: Path) -> None:
    irsim.run(text=APPEAR, record=tmp_path / "run")
    run = open_run(tmp_path / "run")
    there = ~np.isnan(run.trace().pose[:, :, 0])
    assert there.argmax(axis=0).tolist() == [0, 10, 20, 14]
    assert there.sum(axis=0).tolist() == [len(there) - first for first in (0, 10, 20, 14)]
    objects = {item["name"]: item for item in pack_run(run).head["objects"]}
    assert [objects[name].get("from", 0) for name in ("first", "late", "crate", "walker")] == [0, 10, 20, 14]
    assert "until" not in objects["first"]


def test_pictures_show_it_only_when_it_is_there_and_snapshots_of_the_start_as_a_ghost(make: Make) -> None:
    env = make(APPEAR)

    def bodies(scene: Any) -> dict[int, float]:
        return {mark.object: mark.alpha for mark in scene.marks if mark.part == "body"}

    assert set(bodies(SceneBuilder(env.simulation).build())) == {0}
    ghosts = bodies(legible_scene(env.simulation)[0])
    assert set(ghosts) == {0, 1, 2, 3}
    assert ghosts[1] < 0.3 < ghosts[0]
    take_steps(env, 10)
    assert set(bodies(legible_scene(env.simulation)[0])) == {0, 1}
    take_steps(env, 11)
    assert set(bodies(SceneBuilder(env.simulation).build())) == {0, 1, 2, 3}


def test_who_starts_where_another_one_appears_is_no_mistake_but_a_wall_is() -> None:
    assert messages(APPEAR, "initial-overlap") == []
    walled = APPEAR.replace("state: [5, 6, 0]", "state: [1, 3, 0]").replace("appear_time: 2", "color: red")
    assert ["never appears" in message for message in messages(walled, "initial-overlap")] == [True, True]
    assert irsim.validate(text=walled).valid, "these are warnings"


def test_a_time_limit_before_the_appearance_is_reported() -> None:
    text = APPEAR.replace("time_limit: 30", "time_limit: 8.5").replace("goal: [9, 1]", "goal: [3, 1]")
    assert any("after its appear_time of 1 s" in message for message in messages(text, "time-too-short"))


# start_time
def first_moves(env: Any, steps: int = 40) -> list[int]:
    """Number of the step in which each object first moved."""
    places = [positions(env)]
    for _ in range(steps):
        env.step()
        places.append(positions(env))
    return (np.array(places) != places[0]).any(axis=2).argmax(axis=0).tolist()


def test_objects_move_from_their_start_time_on(make: Make) -> None:
    env = make(START)
    assert first_moves(env) == [1, 11, 27, 4]
    env.reset()
    assert env.robot_list[2].velocity[:, 0].tolist() == [0, 0], "it stands although it has an initial velocity"
    assert first_moves(env) == [1, 11, 27, 4]


def test_a_waiting_object_is_seen_and_hit(make: Make) -> None:
    env = make("""
world: {width: 10, height: 10}
robot:
  - {state: [1, 1, 0], goal: [9, 1], kinematics: {name: diff}, shape: {name: circle, radius: 0.2},
     behavior: {name: dash}, sensors: [{name: lidar2d, number: 1}]}
  - {state: [3, 1, 0], goal: [9, 1], kinematics: {name: diff}, shape: {name: circle, radius: 0.2},
     behavior: {name: dash}, start_time: 60}
""")
    assert env.robot.lidar.range_data[0] == pytest.approx(1.8)
    take_steps(env, 30)
    assert [view.collision for view in env.robot_list] == [True, True]


def test_perturbed_starts_are_delayed_from_the_start_time_on() -> None:
    plain, late = (
        {robot.name: robot.time_to_goal for robot in irsim.run(text=START, seed=1, perturb=perturb).robots}
        for perturb in (None, "delay=2,objects=robot_1")
    )
    assert late["robot_1"] > plain["robot_1"] >= 1.0 + 7.8
    assert late["robot_2"] == plain["robot_2"]


def test_the_summary_and_the_checks_know_the_start_time() -> None:
    late = START.replace("2.55", "100")
    short = irsim.run(text=late, steps=50)
    assert "'robot_2' had not started (start_time 100 s)" in short.summary
    assert "'robot_2' still waits 8.00 m from its goal (it starts at 100 s)" in str(short.reason)
    (message,) = messages(late.replace("step_time: 0.1", "step_time: 0.1, time_limit: 60"), "time-too-short")
    assert "start_time" in message


def test_waiting_objects_are_drawn_pale_until_they_start(make: Make) -> None:
    env = make(START)
    builder = SceneBuilder(env.simulation)

    def pale() -> list[bool]:
        bodies = [mark for mark in builder.build().marks if mark.part == "body"]
        return [mark.alpha < 1 for mark in sorted(bodies, key=lambda mark: mark.object)]

    assert pale() == [False, True, True, True]
    take_steps(env, 12)
    assert pale() == [False, False, True, False]


def test_a_negative_start_time_is_an_error() -> None:
    findings = irsim.validate(text=START.replace("start_time: 0.3", "start_time: -1")).findings
    assert ("error", "obstacle[0].start_time") in {(f.severity, f.path) for f in findings}
