"""Parquet files as pandas, DuckDB and pyarrow read them."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

import irsim
from irsim.runs import Run, open_run
from tests.bridges.export.conftest import HALL

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

    other = open_run(str(irsim.run(text=HALL, seed=4, steps=10, record=True).run_id))
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


def test_scans_end_where_the_record_has_no_more(workspace: object, monkeypatch: pytest.MonkeyPatch) -> None:
    import pandas

    monkeypatch.setattr("irsim.runs.recorder._MAX_SCANS_BYTES", 4 * 16 * 20)
    run = open_run(str(irsim.run(text=HALL, seed=3, steps=60, record=True).run_id))
    result = irsim.export_run(run, "run.parquet")
    frame = pandas.read_parquet("run.parquet")
    rover = frame[frame.name == "rover 1"]
    assert rover.ranges_0.notna().tolist() == [step < 20 for step in range(61)]
    assert result.notes == ["scans recorded until step 19 of 60 (too large)"]
