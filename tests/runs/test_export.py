"""Exports that need no library: NumPy arrays and CSV tables, what is chosen, and what is refused."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.bridges.export.registry import find_format, format_names
from irsim.cli.app import app
from irsim.common.files import TargetError
from irsim.runs import Run, RunError, open_run
from irsim.simulation.trace import join_traces
from tests.runs.conftest import recorded
from tests.runs.test_trace import assert_same

TRAFFIC = """\
world: {width: 12, height: 8, collision_mode: unobstructed}
robot:
  - name: rover
    kinematics: {name: diff}
    state: [1, 1, 0]
    goal: [5, 1, 0]
    behavior: {name: dash}
    sensors: [{name: lidar2d, number: 5, range_max: 3}, {name: lidar2d, number: 3, range_max: 9, offset: [0.1, 0, 1]}]
  - {name: glider, kinematics: {name: omni_angular}, state: [1, 4, 1], goal: [5, 6, 1], behavior: {name: dash}}
obstacle:
  - {name: walker, kinematics: {name: omni}, state: [6, 6, 0], goal: [9, 2, 0], behavior: {name: dash}}
  - {name: crate, shape: {name: circle, radius: 0.5}, state: [4, 5, 0]}
"""


@pytest.fixture
def traffic(workspace: Path) -> Run:
    """A run with two drives, two lidars, a moving and a static obstacle."""
    return recorded(text=TRAFFIC, seed=3, steps=25)


def table(path: Path) -> list[dict[str, str]]:
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("rows", [1, 7, 26, 1000])
def test_blocks_are_the_trace_in_parts(traffic: Run, rows: int) -> None:
    blocks = list(traffic.blocks(rows))
    assert [len(block) for block in blocks] == [min(rows, 26 - begin) for begin in range(0, 26, rows)]
    assert_same(join_traces(blocks), traffic.trace())
    [one] = traffic.blocks(26, [2, 0], scans=False)
    assert one.names == ("walker", "rover")
    np.testing.assert_array_equal(one.pose, traffic.trace().pose[:, [2, 0]])
    np.testing.assert_array_equal(one.control, traffic.trace().control[:, [2, 0]])
    np.testing.assert_array_equal(one.goal, traffic.trace().goal[:, [2, 0]])
    assert one.ranges == {}


def test_npz_has_the_trace_by_name(traffic: Run) -> None:
    result = irsim.export_run(traffic, "run.npz")
    assert (result.run_ids, result.format, result.steps, result.notes) == ([traffic.id], "npz", 25, [])
    trace, movers = traffic.trace(), [0, 1, 2]
    with np.load("run.npz", allow_pickle=False) as arrays:
        for name in ("pose", "control", "goal", "arrived", "collided", "stopped"):
            np.testing.assert_array_equal(arrays[name], getattr(trace, name)[:, movers])
        np.testing.assert_array_equal(arrays["time"], trace.time)
        np.testing.assert_array_equal(arrays["step"], np.arange(26))
        assert arrays["names"].tolist() == result.objects == ["rover", "glider", "walker"]
        assert arrays["roles"].tolist() == ["robot", "robot", "obstacle"]
        for key in ("rover/0", "rover/1"):
            np.testing.assert_array_equal(arrays[f"ranges/{key}"], trace.ranges[key])
        about = json.loads(str(arrays["about"]))
    assert about["run"]["scenario_text"] == TRAFFIC
    assert (about["run"]["seed"], about["run"]["step_time"]) == (3, 0.1)
    assert [item["name"] for item in about["run"]["objects"]] == ["rover", "glider", "walker", "crate"]


def test_velocities_are_those_of_the_motion(traffic: Run) -> None:
    irsim.export_run(traffic, "run.npz")
    with np.load("run.npz") as arrays:
        pose, velocity, control = arrays["pose"], arrays["velocity"], arrays["control"]
    assert np.isnan(velocity[0]).all()
    heading = pose[:-1, 0, 2]
    forward = velocity[1:, 0, 0] * np.cos(heading) + velocity[1:, 0, 1] * np.sin(heading)
    np.testing.assert_allclose(forward, control[1:, 0, 0], atol=1e-6)  # rover drives where it looks
    np.testing.assert_allclose(velocity[1:, 0, 2], control[1:, 0, 1], atol=1e-6)
    np.testing.assert_allclose(
        np.cumsum(velocity[1:, :, :2], axis=0) * 0.1, pose[1:, :, :2] - pose[0, :, :2], atol=1e-9
    )


@pytest.mark.parametrize("numbers", [1, 150, 400])
def test_size_of_blocks_changes_no_file(traffic: Run, monkeypatch: pytest.MonkeyPatch, numbers: int) -> None:
    whole, parts = {}, {}
    for made in (whole, parts):
        for name in ("run.npz", "run.csv"):
            irsim.export_run(traffic, name, ranges=True, overwrite=True)
            made[name] = Path(name).read_bytes()
        monkeypatch.setattr("irsim.bridges.export.episode._BLOCK_NUMBERS", numbers)
    assert whole["run.csv"] == parts["run.csv"]
    with np.load("run.npz") as arrays:
        np.testing.assert_array_equal(arrays["pose"], traffic.trace().pose[:, :3])
    assert len(whole["run.npz"]) == len(parts["run.npz"])


def test_csv_reads_back_exactly(traffic: Run) -> None:
    irsim.export_run(traffic, "run.csv", ranges=True)
    rows, trace = table(Path("run.csv")), traffic.trace()
    assert [(int(row["step"]), row["name"]) for row in rows[:4]] == [
        (0, "rover"), (0, "glider"), (0, "walker"), (1, "rover"),
    ]  # fmt: skip
    x = np.array([float(row["x"]) for row in rows]).reshape(26, 3)
    np.testing.assert_array_equal(x, trace.pose[:, :3, 0])
    for number, row in enumerate(rows):
        step, column = divmod(number, 3)
        assert row["run"] == traffic.id
        assert row["role"] == ("obstacle" if row["name"] == "walker" else "robot")
        assert row["arrived"] == str(int(trace.arrived[step, column]))
        away = math.dist(trace.pose[step, column, :2], trace.goal[step, column, :2])
        assert float(row["goal_distance"]) == pytest.approx(away, abs=1e-12)
        assert (row["control_2"] == "") == (row["name"] != "glider" or step == 0)
        assert (row["speed"] == "") == (step == 0)
        for key in ("0", "1"):
            scan = [float(word) for word in row[f"ranges_{key}"].split()]
            kept = trace.ranges[f"rover/{key}"][step].tolist() if row["name"] == "rover" else []
            assert np.float32(scan).tolist() == kept


def test_scans_stay_out_of_csv_unless_asked_for(traffic: Run) -> None:
    irsim.export_run(traffic, "run.csv")
    assert not any(name.startswith("ranges") for name in table(Path("run.csv"))[0])
    irsim.export_run(traffic, "run.npz", ranges=False)
    with np.load("run.npz") as arrays:
        assert not any(name.startswith("ranges") for name in arrays.files)


def test_objects_are_chosen_by_kind_or_name(traffic: Run) -> None:
    for objects, names in (
        ("robots", ["rover", "glider"]),
        ("all", ["rover", "glider", "walker", "crate"]),
        (["crate", "rover"], ["crate", "rover"]),
    ):
        assert irsim.export_run(traffic, "run.csv", objects=objects, overwrite=True).objects == names
        assert [row["name"] for row in table(Path("run.csv"))[: len(names)]] == names
    crate = table(Path("run.csv"))[2]
    assert [crate[key] for key in ("name", "x", "vx", "control_0", "goal_x")] == ["crate", "4.0", "0.0", "", ""]
    for objects, message in ((["rovr"], "did you mean 'rover'"), ("robot", "choose movers, robots, people, all")):
        with pytest.raises(RunError, match=message):
            irsim.export_run(traffic, "other.csv", objects=objects)


def test_several_runs_are_one_table(traffic: Run, room: Path) -> None:
    other = str(irsim.run(room, seed=0, record=True).run_id)
    result = irsim.export_run([traffic, other], "both.csv")
    rows = table(Path("both.csv"))
    assert [row["run"] for row in rows] == [traffic.id] * 26 * 3 + [other] * open_run(other).trace().step.size
    assert result.steps == 25 + open_run(other).last_step
    with pytest.raises(RunError, match="npz holds one run, got 2"):
        irsim.export_run([traffic, other], "both.npz")
    with pytest.raises(RunError, match="name it with -o"):
        irsim.export_run([traffic, other], to="csv")


def test_formats_are_found_by_module_and_suffix() -> None:
    for name in format_names():
        export_format = find_format(name, None)
        assert export_format.name == name
        assert (
            find_format(None, Path(f"x{'' if export_format.folder else f'.{name}'}{export_format.suffix}"))
            is export_format
        )
    assert {"parquet", "csv", "npz", "mcap", "minari"} <= set(format_names())
    for name, out, message in (
        ("parqet", None, "unknown-format: 'parqet' is not a format of runs. Fix: did you mean parquet"),
        (
            None,
            Path("x.txt"),
            "unknown-format: the suffix of 'x.txt' does not select a format. Fix: end it with one of .csv",
        ),
        (None, Path("x.txt"), r"\.isaac_people\.txt"),
        (None, Path("x.xml"), "files of commonroad and mjcf end with .xml. Fix: name the file x.commonroad.xml, or"),
        (None, None, "no format was given"),
    ):
        with pytest.raises(RunError, match=message):
            find_format(name, out)


def test_what_cannot_be_written_leaves_nothing(traffic: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("plain").write_text("a file")
    Path("full-v0").mkdir()
    before = sorted(path.name for path in Path().iterdir())
    with pytest.raises(TargetError, match="file-access"):
        irsim.export_run(traffic, "plain/run.csv")
    with pytest.raises(TargetError, match="unknown-format"):
        irsim.export_run(traffic, "run.txt", to="csv")
    with pytest.raises(RunError, match="unknown-run"):
        irsim.export_run("room-000000", "run.csv")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("irsim.bridges.export.formats.csv._texts", full)
    with pytest.raises(RunError, match=r"'run\.csv' cannot be written: No space left on device"):
        irsim.export_run(traffic, "run.csv")
    assert sorted(path.name for path in Path().iterdir()) == before


def test_a_missing_library_names_the_extra(traffic: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.common.extras.find_spec", lambda name: None)
    for to, names in (("parquet", "pyarrow is"), ("mcap", "mcap and rosbags are"), ("minari", "minari and h5py are")):
        with pytest.raises(ImportError, match=rf"{names} not installed.*pip install 'irsim-mcp\[records\]'"):
            irsim.export_run(traffic, to=to)
    assert irsim.export_run(traffic, to="csv").file == f"{traffic.id}.csv"


def test_the_command_exports(traffic: Run, room: Path) -> None:
    console = CliRunner()
    done = console.invoke(app, ["export", traffic.id, "--to", "csv", "-o", "out/run.csv", "--objects", "rover, walker"])
    assert done.exit_code == 0, done.output
    assert done.stdout.startswith("wrote out/run.csv (")
    assert {row["name"] for row in table(Path("out/run.csv"))} == {"rover", "walker"}
    irsim.run(room, seed=0, record=True)
    told = json.loads(console.invoke(app, ["export", "--to", "npz", "--json"]).stdout)
    assert told["run_ids"] == [open_run("last").id]
    assert Path(told["file"]).stat().st_size == told["bytes"]
    for arguments in (["export", "nothing-000000", "--to", "csv"], ["export", "--to", "exe"], ["export"]):
        assert console.invoke(app, arguments).exit_code == 2


def test_a_run_is_written_when_it_is_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    scene = "world: {width: 5, height: 5}\nrobot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [2, 1, 0]}\n"
    result = irsim.run(text=scene, seed=0, steps=7, export=[tmp_path / "run.npz", tmp_path / "run.csv"])
    assert result.files == [str(tmp_path / "run.npz"), str(tmp_path / "run.csv")]
    with np.load(tmp_path / "run.npz") as arrays:
        assert len(arrays["step"]) == 8
    assert result.run_id is None
    assert not (tmp_path / ".irsim").exists()
    with pytest.raises(RunError, match="unknown-format"):
        irsim.run(text=scene, seed=0, export="run.pdf")


def test_the_help_lists_all_formats() -> None:
    shown = CliRunner().invoke(app, ["export", "--help"], env={"COLUMNS": "400"}).output
    words = " ".join(shown.replace("│", " ").split())
    *names, last = format_names()
    assert f"Name of a format: {', '.join(names)} or {last}." in words
