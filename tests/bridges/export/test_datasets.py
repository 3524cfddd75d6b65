"""Datasets as minari loads them, and Parquet files as pandas, DuckDB and pyarrow read them."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.common.files import TargetError
from irsim.runs import Run, RunError
from tests.bridges.export.conftest import HALL
from tests.bridges.scenes import recorded

pytestmark = pytest.mark.records


def test_pandas_reads_what_was_recorded(hall: Run) -> None:
    import pandas

    irsim.export_run(hall, "run.parquet")
    frame, trace = pandas.read_parquet("run.parquet"), hall.trace()
    assert len(frame) == 3 * 61
    for column, name in enumerate(("rover 1", "rover 2", "walker")):
        rows = frame[frame.name == name]
        np.testing.assert_array_equal(rows[["x", "y", "theta"]], trace.pose[:, column])
        np.testing.assert_array_equal(rows[["goal_x", "goal_y", "goal_theta"]], trace.goal[:, column])
        np.testing.assert_array_equal(rows.step, trace.step)
        np.testing.assert_array_equal(rows.arrived, trace.arrived[:, column])
        np.testing.assert_array_equal(rows.control_0[1:], trace.control[1:, column, 0])
        assert math.isnan(rows.speed.iloc[0])
        if name != "walker":
            np.testing.assert_array_equal(np.stack(rows.ranges_1), trace.ranges[f"{name}/1"])
        else:
            assert rows.ranges_1.isna().all()
    assert frame.speed.max() == pytest.approx(1, abs=1e-6)


def test_duckdb_answers_questions(hall: Run) -> None:
    import duckdb

    other = recorded(HALL, 10, seed=4)
    irsim.export_run([hall, other], "runs.parquet", objects="all")
    trace = hall.trace()
    counts = duckdb.sql("select run, name, count(*) from 'runs.parquet' group by all").fetchall()
    assert {(run, rows) for run, _, rows in counts} == {(hall.id, 61), (other.id, 11)}
    assert len(counts) == 2 * 5
    [(nearest,)] = duckdb.sql(f"""
        select min(list_min(ranges_0)) from 'runs.parquet' where name = 'rover 1' and run = '{hall.id}'
    """).fetchall()
    assert nearest == float(trace.ranges["rover 1/0"].min()) < 3
    [(arrived,)] = duckdb.sql(f"""
        select min(time) from 'runs.parquet' where arrived and name = 'rover 1' and run = '{hall.id}'
    """).fetchall()
    assert arrived == next(event.time for event in hall.events if event.kind == "arrival")


def test_units_and_scenario_are_in_the_file(hall: Run) -> None:
    from pyarrow import parquet

    irsim.export_run(hall, "run.parquet")
    schema = parquet.read_schema("run.parquet")
    units = {field.name: field.metadata[b"unit"].decode() for field in schema}
    assert (units["x"], units["theta"], units["vx"], units["yaw_rate"], units["time"]) == (
        "m", "rad", "m/s", "rad/s", "s",
    )  # fmt: skip
    assert units["control_0"] == "m/s"
    assert units["control_1"] == "rad/s (diff), m/s (omni)"
    assert units["ranges_0"] == "m"
    assert schema.metadata[b"irsim"].decode() == irsim.__version__
    [run] = json.loads(schema.metadata[b"irsim.runs"])
    assert (run["id"], run["seed"], run["step_time"], run["irsim"]) == (hall.id, 3, 0.1, irsim.__version__)
    assert run["scenario_text"] == HALL
    assert [item["name"] for item in run["objects"]] == ["rover 1", "rover 2", "walker", "crate", "hook"]
    assert [(lidar["object"], lidar["beams"]) for lidar in run["lidars"]][:2] == [("rover 1", 5), ("rover 1", 3)]


def test_row_groups_are_small_and_change_nothing(hall: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    from pyarrow import parquet

    irsim.export_run(hall, "whole.parquet")
    monkeypatch.setattr("irsim.bridges.export.episode._BLOCK_NUMBERS", 640)
    irsim.export_run(hall, "parts.parquet")
    assert parquet.ParquetFile("whole.parquet").num_row_groups == 1
    assert parquet.ParquetFile("parts.parquet").num_row_groups > 5
    whole, parts = parquet.read_table("whole.parquet"), parquet.read_table("parts.parquet")
    assert whole.to_pylist() == parts.to_pylist()


def test_scans_end_where_the_record_has_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    import pandas

    monkeypatch.setattr("irsim.runs.recorder._MAX_SCANS_BYTES", 4 * 16 * 20)
    run = recorded(HALL, 60, seed=3)
    result = irsim.export_run(run, "run.parquet")
    frame = pandas.read_parquet("run.parquet")
    rover = frame[frame.name == "rover 1"]
    assert rover.ranges_0.notna().tolist() == [step < 20 for step in range(61)]
    assert result.notes == ["scans recorded until step 19 of 60 (too large)"]


pytestmark = pytest.mark.records


@pytest.fixture
def minari(monkeypatch: pytest.MonkeyPatch, workspace: Path) -> Any:
    """The library, with datasets in the current directory."""
    import minari as library

    monkeypatch.setenv("MINARI_DATASETS_PATH", str(workspace))
    return library


def test_an_episode_for_each_robot(hall: Run, minari: Any) -> None:
    result = irsim.export_run(hall, "hall-v0", to="minari")
    assert result.file == "hall-v0"
    dataset, trace = minari.load_dataset("hall-v0"), hall.trace()
    assert dataset.total_episodes == 2
    first, second = dataset[0], dataset[1]
    arrival = next(event.step for event in hall.events if (event.kind, event.object) == ("arrival", "rover 1"))
    assert 0 < arrival < 60
    assert (len(first), len(second)) == (arrival, 60)
    assert dataset.total_steps == arrival + 60
    for column, episode in enumerate((first, second)):
        steps = len(episode)
        np.testing.assert_array_equal(episode.observations["pose"], trace.pose[: steps + 1, column])
        np.testing.assert_array_equal(episode.actions, np.float32(trace.control[1 : steps + 1, column, :2]))
        np.testing.assert_array_equal(episode.infos["step"], np.arange(steps + 1))
        np.testing.assert_array_equal(episode.infos["goal"], trace.goal[: steps + 1, column])
        for number in range(steps + 1):
            assert dataset.observation_space.contains({k: v[number] for k, v in episode.observations.items()})
        assert all(dataset.action_space.contains(action) for action in episode.actions)
    assert first.terminations.tolist() == [False] * (arrival - 1) + [True]
    assert not first.truncations.any()
    assert not second.terminations.any()
    assert second.truncations.tolist() == [False] * 59 + [True]
    assert first.rewards.tolist() == [0] * (arrival - 1) + [1]
    assert second.rewards.sum() == 0


def test_goals_and_velocities_are_in_the_frame_of_the_robot(hall: Run, minari: Any) -> None:
    irsim.export_run(hall, "hall-v0", to="minari")
    episode, trace = minari.load_dataset("hall-v0")[1], hall.trace()
    for row in (0, 1, 40):
        x, y, theta = trace.pose[row, 1].tolist()
        goal_x, goal_y, goal_theta = trace.goal[row, 1].tolist()
        bearing = math.atan2(goal_y - y, goal_x - x) - theta
        away = math.hypot(goal_x - x, goal_y - y)
        wanted = (away * math.cos(bearing), away * math.sin(bearing), math.remainder(goal_theta - theta, 2 * math.pi))
        assert episode.observations["goal"][row] == pytest.approx(wanted)
    velocity = episode.observations["velocity"]
    assert velocity[0].tolist() == [0, 0, 0]
    np.testing.assert_allclose(velocity[1:, [0, 2]], episode.actions, atol=1e-6)  # what it did is what it then observes


def test_scans_of_all_lidars_are_one_observation(hall: Run, minari: Any) -> None:
    irsim.export_run(hall, "hall-v0", to="minari")
    dataset, trace = minari.load_dataset("hall-v0"), hall.trace()
    scan = dataset[1].observations["scan"]
    assert scan.shape == (61, 8)
    np.testing.assert_array_equal(scan[:, :5], np.minimum(trace.ranges["rover 2/0"], np.float32(3)))
    np.testing.assert_array_equal(scan[:, 5:], np.minimum(trace.ranges["rover 2/1"], np.float32(9)))
    assert dataset.observation_space["scan"].high.tolist() == [3.0] * 5 + [9.0] * 3
    irsim.export_run(hall, "blind-v0", to="minari", ranges=False)
    assert set(minari.load_dataset("blind-v0").observation_space) == {"pose", "velocity", "goal"}


@pytest.mark.parametrize("numbers", [1, 800])
def test_size_of_blocks_changes_nothing(hall: Run, minari: Any, monkeypatch: pytest.MonkeyPatch, numbers: int) -> None:
    irsim.export_run(hall, "whole-v0", to="minari")
    monkeypatch.setattr("irsim.bridges.export.episode._BLOCK_NUMBERS", numbers)
    irsim.export_run(hall, "parts-v0", to="minari")
    whole, parts = (minari.load_dataset(f"{name}-v0") for name in ("whole", "parts"))
    assert (whole.total_steps, whole.total_episodes) == (parts.total_steps, parts.total_episodes)
    for one, other in zip(whole, parts, strict=True):
        assert len(one) == len(other)
        for field in ("actions", "rewards", "terminations", "truncations"):
            np.testing.assert_array_equal(getattr(one, field), getattr(other, field))
        for field in ("observations", "infos"):
            for key, values in getattr(one, field).items():
                np.testing.assert_array_equal(values, getattr(other, field)[key])
    counts = [[facts["total_steps"] for facts in d.storage.get_episode_metadata([0, 1])] for d in (whole, parts)]
    assert counts[0] == counts[1]


def test_contacts_are_punished_and_end_the_episode_if_they_stop_the_robot(minari: Any) -> None:
    crash = HALL.replace("goal: [5, 1, 0]", "goal: [5, 6, 0]")
    for mode, ends in (("stop", True), ("unobstructed", False)):
        text = crash.replace("unobstructed", mode).replace("state: [4, 4, 0.3]", "state: [3, 3.5, 0.3]")
        run = recorded(text, 60, seed=3)
        begun = [e.step for e in run.events if e.kind == "collision" and "rover 1" in (e.object, e.partner)]
        assert begun
        irsim.export_run(run, f"{mode}-v0", to="minari", objects=["rover 1"])
        episode = minari.load_dataset(f"{mode}-v0")[0]
        assert episode.rewards[begun[0] - 1] == -1
        assert (len(episode) == begun[0]) == ends
        if ends:
            assert episode.terminations[-1]


def test_arrivals_of_a_wanderer_do_not_end_its_episode(minari: Any) -> None:
    text = """\
world: {width: 6, height: 6}
robot:
  - name: nomad
    shape: {name: circle, radius: 0.2}
    kinematics: {name: diff}
    state: [3, 3, 0]
    behavior: {name: dash, wander: true, range_low: [2, 2, -3.14], range_high: [4, 4, 3.14]}
  - {name: far, shape: {name: circle, radius: 0.2}, kinematics: {name: diff}, state: [1, 1, 0], goal: [5, 1, 0]}
"""
    run = recorded(text, 400)
    arrivals = [event.step for event in run.events if event.kind == "arrival"]
    assert len(arrivals) > 2
    irsim.export_run(run, "nomad-v0", to="minari", objects=["nomad"])
    episode = minari.load_dataset("nomad-v0")[0]
    assert len(episode) == 400
    assert (np.flatnonzero(episode.rewards == 1) + 1).tolist() == arrivals
    assert not episode.terminations.any()


def test_several_runs_are_one_dataset_with_their_seeds(hall: Run, minari: Any) -> None:
    other = recorded(HALL, 20, seed=9)
    irsim.export_run([hall, other], "both-v3", to="minari")
    dataset = minari.load_dataset("both-v3")
    facts = list(dataset.storage.get_episode_metadata(range(4)))
    assert [(item["run"], item["robot"], item["seed"]) for item in facts] == [
        (run.id, robot, seed) for run, seed in ((hall, 3), (other, 9)) for robot in ("rover 1", "rover 2")
    ]
    assert [item["scenario"] for item in facts] == [HALL] * 4
    assert dataset.storage.metadata["dataset_id"] == "both-v3"


def test_what_is_no_dataset_is_refused_and_leaves_nothing(hall: Run, minari: Any) -> None:
    for name, objects, message in (
        ("hall", "movers", "end the name with -v and a number"),
        ("hall-v0", ["walker"], "no robot has a goal and can move"),
    ):
        with pytest.raises(RunError, match=message):
            irsim.export_run(hall, name, to="minari", objects=objects)
    mixed = recorded(HALL.replace("diff", "omni", 1), 5, seed=3)
    with pytest.raises(RunError, match="'rover 1' and 'rover 2' have different controls or lidars"):
        irsim.export_run(mixed, "mixed-v0", to="minari")
    assert [path.name for path in Path().iterdir()] == [".irsim"]
    irsim.export_run(hall, "hall-v0", to="minari")
    with pytest.raises(TargetError, match="'hall-v0' exists"):
        irsim.export_run(hall, "hall-v0", to="minari")


def test_a_table_in_one_step_is_the_parquet_file(hall: Run) -> None:
    import pandas

    irsim.export_run(hall, "run.parquet", objects="all")
    result = hall.result
    assert result is not None
    frame = result.to_pandas(objects="all", ranges=True)
    pandas.testing.assert_frame_equal(frame, pandas.read_parquet("run.parquet"), check_dtype=False)
    assert (frame.attrs["units"]["speed"], frame.attrs["units"]["run"]) == ("m/s", "")
    assert "ranges_0" not in result.to_pandas()
