"""The table of episodes of a benchmark, as pandas, DuckDB and pyarrow read it."""

from __future__ import annotations

from pathlib import Path

import pytest

import irsim
from irsim.api.benchmark_report import TABLE, write_report
from irsim.benchmarks.plan import file_plan
from irsim.benchmarks.stored import run_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.results.benchmark import SuiteResult

pytestmark = pytest.mark.records

SUITE = """
suite: small
version: 3
title: Robots in a square
scenarios:
  - name: square
    vary: {"robot[0].number": [2, 70], "robot[0].distribution": [{name: random}, {name: circle, radius: 2}]}
    scenario:
      world: {width: 8, height: 8, zones: [{name: door, line: [[4, 0], [4, 8]]}]}
      robot:
        - {number: 2, kinematics: {name: diff}, shape: {name: circle, radius: 0.4}, distribution: {name: random}}
  - name: alone
    vary: {courier_speed: [0.5, 1]}
    template: crossing
seeds: {first: 5, count: 3}
steps: 30
protocols: [freeze, yield]
policies: {orca: {name: orca, timeHorizon: 2}, dash: dash}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, SuiteResult]:
    """A folder with the report of a small suite, and its result."""
    place = tmp_path_factory.mktemp("table")
    (place / "small.yaml").write_text(SUITE, encoding="utf-8")
    result = run_plan(suite_plan(str(place / "small.yaml")), place / "run")
    assert isinstance(result, SuiteResult)
    assert write_report(result, place / "run").notes == []
    return place / "run", result


def test_pandas_reads_every_episode(folder: tuple[Path, SuiteResult]) -> None:
    import pandas

    place, result = folder
    frame = pandas.read_parquet(place / TABLE)
    assert len(frame) == len(result.episodes)
    names = {text: name for name, text in result.policies.items()}
    for (_, row), episode in zip(frame.iterrows(), result.episodes, strict=True):
        fact = next(fact for fact in result.facts if fact.name == episode.scenario)
        assert (row.scenario, row.family, row.protocol) == (fact.name, fact.family, fact.protocol)
        assert (row.policy, row.behavior, row.seed) == (names[episode.behavior], episode.behavior, episode.seed)
        assert (row.outcome, row.steps, row.sim_time) == (episode.outcome, episode.steps, episode.sim_time)
        for key, value in episode.metrics.items():
            assert pandas.isna(row[key]) if value is None else row[key] == value
        for key in ("robot[0].number", "courier_speed"):
            given = row[f"values.{key}"]
            assert pandas.isna(given) if key not in fact.values else given == fact.values[key]
    assert frame.outcome.isin(["success", "collision", "timeout", "placement-crowded"]).all()
    assert (frame.outcome == "placement-crowded").any()
    assert frame["zones.door.zone_crossings"].notna().any()


def test_a_table_in_one_step_is_the_file(folder: tuple[Path, SuiteResult]) -> None:
    import pandas

    place, result = folder
    frame, written = result.to_pandas(), pandas.read_parquet(place / TABLE)
    for key in ("left", "jumped"):  # lists, which the file has as arrays
        frame[key], written[key] = frame[key].map(list), written[key].map(list)
    plain = [table.astype(object).where(table.notna(), None) for table in (frame, written)]
    pandas.testing.assert_frame_equal(*plain)
    assert frame.attrs["units"]["jerk_avg"] == "m/s^3"


def test_duckdb_answers_questions(folder: tuple[Path, SuiteResult]) -> None:
    import duckdb

    place, result = folder
    rates = duckdb.sql(f"""
        select scenario, behavior, avg((outcome = 'timeout')::int) from '{place / TABLE}'
        where outcome <> 'placement-crowded' group by all
    """).fetchall()
    rows = {(row.scenario, row.behavior): row.timeout.rate for row in result.rows}
    assert 0 < sum(rows.values()) < len(rows)
    assert {(scenario, behavior): rate for scenario, behavior, rate in rates} == pytest.approx(rows)
    [(count,)] = duckdb.sql(f"""select count(*) from '{place / TABLE}' where "values.robot[0].number" = 2""").fetchall()
    assert count == 2 * 2 * (3 + 1)  # nothing is random on the circle, so it has one seed


def test_units_and_origin_are_in_the_file(folder: tuple[Path, SuiteResult]) -> None:
    from pyarrow import parquet

    place, result = folder
    schema = parquet.read_schema(place / TABLE)
    units = {field.name: field.metadata[b"unit"].decode() for field in schema}
    assert (units["sim_time"], units["jerk_avg"], units["path_length"], units["success"]) == ("s", "m/s^3", "m", "0/1")
    assert (units["seed"], units["zones.door.zone_crossings"]) == ("", "count")
    assert all(field.metadata[b"description"] for field in schema)
    assert schema.metadata == {
        b"irsim": irsim.__version__.encode(),
        b"irsim.hash": result.hash.encode(),
        b"irsim.reproduce": result.reproduce.encode(),
        b"irsim.suite": b"small",
        b"irsim.suite_version": b"3",
    }


def test_the_same_result_gives_the_same_bytes(folder: tuple[Path, SuiteResult], tmp_path: Path) -> None:
    place, result = folder
    run_plan(suite_plan(str(place.parent / "small.yaml")), tmp_path / "again", workers=1)
    write_report(result, tmp_path / "again")
    assert (tmp_path / "again" / TABLE).read_bytes() == (place / TABLE).read_bytes()


def test_a_benchmark_of_files_has_the_largest_seed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import pandas

    monkeypatch.chdir(tmp_path)
    Path("a.yaml").write_text("robot: {distribution: {name: random}, goal: [9, 9, 0], behavior: {name: dash}}\n")
    plan = file_plan(["a.yaml"], ["dash"], f"0,{2**64 - 1}", steps=5)
    write_report(run_plan(plan, Path("run")), Path("run"))
    frame = pandas.read_parquet(Path("run", TABLE))
    assert frame.seed.tolist() == [0, 2**64 - 1]
    assert not {"family", "protocol"} & set(frame.columns)
