"""`appear_time`: objects that come into the world after its start."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim

Make = Callable[..., Any]
SHAPES = {
    "circle": "{name: circle, radius: 0.4}",
    "rectangle": "{name: rectangle, length: 0.8, width: 0.8}",
    "polygon": "{name: polygon, vertices: [[-0.4, -0.4], [0.4, -0.4], [0.4, 0.4], [-0.4, 0.4]]}",
    "linestring": "{name: linestring, vertices: [[-0.4, -1], [-0.4, 1]]}",
    "compound": "{name: compound, parts: [{name: rectangle, length: 0.8, width: 0.8}, {name: circle, radius: 0.1}]}",
}
TEXT = """
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


def positions(env: Any) -> Any:
    return np.array(env.simulation.pose)[:, :2]


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
    for _ in range(29):
        env.step()
        assert env.robot.lidar.range_data[0] == 20
    env.step()
    assert env.robot.lidar.range_data[0] == pytest.approx(2.6, abs=0.1)
    assert env.robot.state[0, 0] == pytest.approx(5, abs=0.1), (
        "it drove through the place of the object that comes later"
    )
    assert not env.robot.collision
    for _ in range(30):
        env.step()
    touched = env.robot.collision if mode == "stop" else env.robot.state[0, 0] < 7.7 or positions(env)[2, 0] > 8
    assert touched


def test_its_position_is_undefined_and_its_lidar_measures_nothing_until_then(make: Make) -> None:
    env = make(TEXT)
    late = env.get_object_by_name("late")
    assert np.isnan(late.state[:2, 0]).all()
    assert late.lidar.range_data.tolist() == [10] * 3
    for _ in range(10):
        env.step({"late": [1.0, 0.0]})
    assert late.state[:, 0].tolist() == [1, 3, 0]
    env.step()
    assert late.state[0, 0] == pytest.approx(1.1)
    env.reset()
    assert np.isnan(late.state[:2, 0]).all()


def test_whose_place_is_taken_waits_until_there_is_room(make: Make, tmp_path: Path) -> None:
    env = make(TEXT)
    for _ in range(13):
        env.step()
        assert np.isnan(positions(env)[3]).all(), "the robot 'late' appeared in the same place"
    env.step()
    assert positions(env)[3].tolist() == [1, 3]
    assert not any(view.collision for view in env.objects)
    (tmp_path / "late.yaml").write_text(TEXT)
    assert "'walker' appeared 0.4 s late, when there was room at its start" in irsim.run(tmp_path / "late.yaml").summary


def test_the_summary_names_who_never_appeared(tmp_path: Path) -> None:
    path = tmp_path / "late.yaml"
    path.write_text(TEXT.replace("appear_time: 2", "appear_time: 20"))
    result = irsim.run(path, steps=5)
    assert "'late' did not appear (it appears at 1 s)" in result.summary
    assert "'crate' did not appear (it appears at 20 s)" in result.summary
    assert "'late' is not in the world yet, 8.00 m from its goal (it appears at 1 s)" in str(result.reason)
    json.loads(result.model_dump_json())
    path.write_text(TEXT.replace("state: [5, 6, 0]", "state: [9, 1, 0]").replace("appear_time: 2", "appear_time: 9"))
    blocked = irsim.run(path, steps=200)
    assert "'crate' did not appear (since 9 s there has been no room for it at its start)" in blocked.summary


def test_batches_rollouts_and_python_steps_equal_single_steps(make: Make, tmp_path: Path) -> None:
    env, path = make(TEXT), tmp_path / "late.yaml"
    path.write_text(TEXT)
    rollout = make(TEXT).rollout(40, until_done=False)
    batch = irsim.batch(path, 2, seeds=[0, 1])
    python = make(TEXT)
    python.simulation.decisions.append(lambda simulation: None)
    for step in range(40):
        env.step()
        batch.step()
        python.step()
        now = np.array(env.simulation.pose)
        row = np.asarray(rollout.pose)[step + 1 - (len(rollout.pose) == 40)]
        for other in (row, np.array(batch.pose[1]), np.array(python.simulation.pose)):
            assert np.array_equal(now, other, equal_nan=True)


def test_followers_plan_anew_round_what_appears(make: Make) -> None:
    env = make("""
world: {width: 10, height: 10, step_time: 0.1}
robot:
  - {state: [1, 5, 0], goal: [9, 5], kinematics: {name: diff}, shape: {name: circle, radius: 0.2},
     behavior: {name: follow}}
obstacle:
  - {state: [6, 5, 0], shape: {name: rectangle, length: 0.4, width: 3}, appear_time: 1}
""")
    for _ in range(200):
        env.step()
    assert env.robot.arrive
    assert not env.robot.collision


def test_crowds_do_not_avoid_who_is_absent(make: Make) -> None:
    """`orca`, `rvo` and `sfm` drive straight through the place where an object will appear."""
    for behavior in ("orca", "rvo", "sfm"):
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
            assert env.robot.state[1, 0] == pytest.approx(5, abs=1e-12), behavior


def test_metrics_count_from_the_appearance_on_and_only_who_is_there(make: Make, tmp_path: Path) -> None:
    from irsim.metrics import episode_metrics
    from irsim.simulation.trace import record

    env = make(TEXT)
    trace = record(env.simulation, 150, until_done=False)
    metrics = episode_metrics(trace, env.simulation, env.events)
    first, late = metrics.robots
    assert late["path_length"] == pytest.approx(first["path_length"], abs=0.15)
    assert late["time_to_goal"] == pytest.approx(first["time_to_goal"] + 1, abs=0.15), "times count from the start"
    assert first["distance_to_human_min"] == pytest.approx(2.03, abs=0.1)
    assert np.isfinite([late["distance_to_human_min"], late["social_work"], late["pedestrian_velocity_avg"]]).all()
    assert late["pedestrian_velocity_avg"] == pytest.approx(0.8, abs=0.1)
    nobody = make(TEXT.replace("appear_time: 1.0, sensors", "appear_time: 100, sensors"))
    trace = record(nobody.simulation, 60, until_done=False)
    missing = episode_metrics(trace, nobody.simulation, nobody.events).robots[1]
    assert missing["success"] == 0
    assert np.isnan(missing["min_clearance"])


def test_a_recorded_run_knows_who_was_there(tmp_path: Path) -> None:
    from irsim.runs import open_run
    from irsim.runs.replay.data import pack_run

    path = tmp_path / "late.yaml"
    path.write_text(TEXT)
    irsim.run(path, record=tmp_path / "run")
    run = open_run(tmp_path / "run")
    there = ~np.isnan(run.trace().pose[:, :, 0])
    assert there.argmax(axis=0).tolist() == [0, 10, 20, 14]
    assert there.sum(axis=0).tolist() == [len(there) - first for first in (0, 10, 20, 14)]
    objects = {item["name"]: item for item in pack_run(run).head["objects"]}
    assert [objects[name].get("from", 0) for name in ("first", "late", "crate", "walker")] == [0, 10, 20, 14]
    assert "until" not in objects["first"]


def test_pictures_show_it_only_when_it_is_there_and_snapshots_of_the_start_as_a_ghost(make: Make) -> None:
    from irsim.objects.drawing.scene_builder import SceneBuilder
    from irsim.rendering.snapshot import legible_scene

    env = make(TEXT)

    def bodies(scene: Any) -> dict[int, float]:
        return {mark.object: mark.alpha for mark in scene.marks if mark.part == "body"}

    assert set(bodies(SceneBuilder(env.simulation).build())) == {0}
    ghosts = bodies(legible_scene(env.simulation)[0])
    assert set(ghosts) == {0, 1, 2, 3}
    assert ghosts[1] < 0.3 < ghosts[0]
    for _ in range(10):
        env.step()
    assert set(bodies(legible_scene(env.simulation)[0])) == {0, 1}
    env.render()
    for _ in range(11):
        env.step()
    assert set(bodies(SceneBuilder(env.simulation).build())) == {0, 1, 2, 3}


def test_who_starts_where_another_one_appears_is_no_mistake_but_a_wall_is() -> None:
    assert not [f for f in irsim.validate(text=TEXT).findings if f.code == "initial-overlap"]
    walled = TEXT.replace("state: [5, 6, 0]", "state: [1, 3, 0]").replace("appear_time: 2", "color: red")
    findings = [f for f in irsim.validate(text=walled).findings if f.code == "initial-overlap"]
    assert [("never appears" in f.message, f.severity) for f in findings] == [(True, "warning")] * 2


def test_a_time_limit_before_the_appearance_is_reported() -> None:
    findings = irsim.validate(
        text=TEXT.replace("time_limit: 30", "time_limit: 8.5").replace("goal: [9, 1]", "goal: [3, 1]")
    ).findings
    assert any("after its appear_time of 1 s" in f.message for f in findings if f.code == "time-too-short")


def test_the_default_time_limit_counts_from_the_appearance(tmp_path: Path) -> None:
    path = tmp_path / "late.yaml"
    path.write_text(
        TEXT.replace(", time_limit: 30", "").replace("appear_time: 1.0, sensors", "appear_time: 100, sensors")
    )
    assert irsim.run(path).outcome == "success"


def test_delays_by_other_names_lead_to_it() -> None:
    findings = irsim.validate(text=TEXT.replace("appear_time: 2", "spawn_time: 2")).findings
    assert any("appear_time" in str(f.fix) for f in findings if f.code == "unknown-key")
