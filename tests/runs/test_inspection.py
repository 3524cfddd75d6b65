"""Looking into a run: each number against one worked out from the trace."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.metrics import Approach
from irsim.runs import Run, RunError, inspection, open_run
from irsim.runs.artifacts import artifact
from irsim.runs.inspection import FIELDS, VIEWS, inspect_run
from irsim.runs.recorder import Recorder
from irsim.runs.resimulation import resimulate
from irsim.runs.store import ARTIFACTS
from tests.runs.conftest import first_row, recorded

PAIR = """\
world: {width: 10, height: 6, time_limit: 6}
robot:
  - {name: left, kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [1, 3, 0], goal: [9, 3, 0],
     vel_max: [1, 1], behavior: {name: dash}}
  - {name: right, kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [9, 3.9, 0], goal: [1, 3.9, 0],
     vel_max: [1, 1], behavior: {name: dash}}
obstacle:
  - {name: crate, shape: {name: rectangle, length: 1, width: 1}, state: [5, 1, 0]}
  - {name: walker, kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [2, 5.5, 0], goal: [2, 5.5, 0],
     behavior: {name: dash}}
"""


@pytest.fixture
def pair(workspace: Path) -> Run:
    """Two robots that pass each other."""
    return recorded(text=PAIR)


@pytest.fixture
def crashed(crash: Path) -> Run:
    """A robot that hits a crate."""
    return recorded(crash)


def test_rows_are_spread_over_the_run(pair: Run) -> None:
    table = inspect_run(pair, limit=10)
    steps = sorted({row[0] for row in table.rows})
    assert (steps[0], steps[-1]) == (0, pair.last_step)
    assert len(table.rows) <= 12
    assert table.next_cursor is None or int(table.next_cursor) == len(table.rows)
    assert [row[2] for row in table.rows[:2]] == ["left", "right"]


def test_rows_say_what_the_trace_says(pair: Run) -> None:
    trace = pair.trace()
    table = inspect_run(pair, robot="right", every=7, fields=FIELDS, limit=None)
    assert table.columns == [
        "step", "time", "robot", "x", "y", "heading", "speed", "turn_rate", "control_0", "control_1", "goal_x",
        "goal_y", "goal_distance", "nearest_hit", "status",
    ]  # fmt: skip
    assert [row[0] for row in table.rows] == list(range(0, len(trace), 7))
    for row in table.rows:
        cells, at = dict(zip(table.columns, row, strict=True)), int(str(row[0]))
        x, y, heading = trace.pose[at, 1]
        speed = 0.0 if at == 0 else float(np.linalg.norm(trace.pose[at, 1, :2] - trace.pose[at - 1, 1, :2])) / 0.1
        assert (cells["x"], cells["y"], cells["heading"]) == (round(x, 4), round(y, 4), round(heading, 4))
        assert cells["speed"] == pytest.approx(speed, abs=1e-4)
        assert cells["goal_distance"] == pytest.approx(math.hypot(x - 1, y - 3.9), abs=1e-4)
        assert cells["nearest_hit"] is None
        assert cells["status"] == ("arrived" if trace.arrived[at, 1] else "under way")


def test_lidar_ranges_are_told(room: Path) -> None:
    run = recorded(room)
    ranges = run.trace().ranges["rover/0"]
    table = inspect_run(run, every=1, fields=["nearest_hit"], limit=None)
    least = [float(row.min()) for row in ranges]
    assert [row[3] for row in table.rows] == [round(value, 4) if math.isfinite(value) else None for value in least]
    assert any(math.isfinite(value) for value in least)


def test_pages_are_the_whole(pair: Run) -> None:
    whole = inspect_run(pair, every=3, limit=None)
    rows, cursor = [], None
    while True:
        page = inspect_run(pair, every=3, limit=7, cursor=cursor)
        assert page.total == len(whole.rows)
        rows += page.rows
        cursor = page.next_cursor
        if cursor is None:
            break
    assert rows == whole.rows


def test_collisions_say_who_where_and_how_fast(crashed: Run) -> None:
    assert crashed.result is not None
    hit = next(event for event in crashed.result.events if event.kind == "collision")
    cells = first_row(crashed, view="collisions")
    assert (cells["object"], cells["partner"], cells["step"]) == ("rover", "crate", hit.step)
    assert cells["speed"] == pytest.approx(1.0, abs=0.01)
    assert cells["partner_speed"] == 0.0
    assert inspect_run(crashed, view="collisions", to_step=hit.step - 1).rows == []


def test_closest_is_between_footprints(pair: Run) -> None:
    table = inspect_run(pair, view="closest")
    rows = {(row[0], row[2]): dict(zip(table.columns, row, strict=True)) for row in table.rows}
    assert set(rows) == {(a, b) for a in ("left", "right") for b in ("left", "right", "crate", "walker") if a != b}
    assert rows["left", "right"]["edge_distance"] == pytest.approx(0.4, abs=0.01)
    assert rows["right", "left"]["edge_distance"] == rows["left", "right"]["edge_distance"]
    assert rows["left", "crate"]["edge_distance"] == pytest.approx(1.3, abs=0.01)
    assert [rows["left", name]["kind"] for name in ("right", "walker", "crate")] == ["robot", "human", "static"]
    distances = [row[1] for row in table.rows]
    assert distances == sorted(distances)
    part = inspect_run(pair, view="closest", to_step=5)
    assert all(int(str(row[4])) <= 5 for row in part.rows)
    walker = inspect_run(pair, view="closest", robot="walker")  # an obstacle that moves
    assert {row[2]: row[1] for row in walker.rows}["left"] == rows["left", "walker"]["edge_distance"]


def test_closest_tells_each_at_its_own_moment(workspace: Path) -> None:
    posts = "".join(
        f"  - {{name: post_{x}, shape: {{name: circle, radius: 0.2}}, state: [{x}, {2.0 + 0.1 * x:.1f}, 0]}}\n"
        for x in range(2, 9)
    )
    text = "world: {width: 10, height: 6, time_limit: 9}\nrobot: {kinematics: {name: omni}, vel_max: [1, 1], shape: "
    text += "{name: circle, radius: 0.2}, state: [1, 1, 0], goal: [9, 1, 0], behavior: {name: dash}}\n"
    run = recorded(text=f"{text}obstacle:\n{posts}")
    table = inspect_run(run, view="closest", limit=None)
    assert [row[2] for row in table.rows] == [f"post_{x}" for x in range(2, 7)]  # five of a kind
    for x, row in enumerate(table.rows, start=2):
        assert row[1] == pytest.approx(1.0 + 0.1 * x - 0.4, abs=0.01)
        assert row[6] == pytest.approx(x, abs=0.06)


def test_a_distance_that_is_no_touch_is_not_told_as_zero(pair: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    near = [Approach(3, 0.000012345, "crate", "static"), Approach(4, 0.0, "right", "robot")]
    monkeypatch.setattr(inspection, "approaches", lambda *given, **more: [near, []])
    assert [row[1] for row in inspect_run(pair, view="closest").rows] == [0.0, 1.2e-05]


def test_speeds_tell_reversing_and_turning(workspace: Path) -> None:
    text = (
        "world: {width: 10, height: 6, time_limit: 2}\nrobot: {name: r, kinematics: {name: diff}, state: [5, 3, 0]}\n"
    )
    (workspace / "plain.yaml").write_text(text)
    env = irsim.make(workspace / "plain.yaml", headless=True, display=False, log_level="ERROR")
    recorder = Recorder(env.simulation, horizon=20, scenario=None, options={})
    for speed, turn in [(0.5, 0.25)] * 5 + [(-0.25, -1.0)] * 5:
        env.step(np.array([[speed], [turn]]))
        recorder.write_if_due()
    recorder.close()
    env.end()
    cells = first_row(recorder.folder, view="speeds")
    assert (cells["max_speed"], cells["min_forward_speed"], cells["max_turn_rate"]) == (0.5, -0.25, 1.0)
    assert first_row(recorder.folder, view="speeds", to_step=5)["min_forward_speed"] == 0.5


@pytest.mark.parametrize("mode", ["steer", "angular"])
def test_speeds_tell_the_steering_angle_of_a_car(workspace: Path, mode: str) -> None:
    text = f"""
world: {{width: 30, height: 20, time_limit: 3}}
robot:
  name: car
  kinematics: {{name: acker, mode: {mode}, psi_max: 0.7}}
  shape: {{name: rectangle, length: 4, width: 1.8, wheelbase: 2.5}}
  state: [5, 10, 0, 0]
  vel_max: [2, 1]
  vel_min: [-2, -1]
"""
    (workspace / "car.yaml").write_text(text)
    env = irsim.make(workspace / "car.yaml", headless=True, display=False, log_level="ERROR")
    recorder = Recorder(env.simulation, horizon=30, scenario=None, options={})
    for turn in [0.3] * 10 if mode == "steer" else [0.3] * 10 + [0.0] * 10:
        env.step(np.array([[1.0], [turn]]))
        recorder.write_if_due()
    recorder.close()
    steered = float(env.robot.state[3, 0])
    env.end()
    assert steered == pytest.approx(0.3)
    assert first_row(recorder.folder, view="speeds")["max_steering"] == pytest.approx(0.3, abs=0.002)


def test_speeds(pair: Run) -> None:
    trace = pair.trace()
    cells = first_row(pair, view="speeds", robot="left")
    way = float(np.linalg.norm(np.diff(trace.pose[:, 0, :2], axis=0), axis=1).sum())
    assert cells["path_length"] == pytest.approx(way, abs=1e-3)
    assert cells["max_speed"] == pytest.approx(1.0, abs=1e-3)
    assert cells["min_forward_speed"] is None  # an omnidirectional drive has no forwards
    assert cells["mean_speed"] == pytest.approx(way / trace.time[-1], abs=1e-3)
    assert cells["max_steering"] is None
    assert first_row(pair, view="speeds", robot="walker")["path_length"] == 0.0


def test_speeds_are_those_until_it_arrived(workspace: Path) -> None:
    text = PAIR.replace("goal: [9, 3, 0]", "goal: [4, 3, 0]")  # left is there long before right
    run = recorded(text=text)
    metrics = irsim.benchmark(text, seeds=[0], workers=1).episodes[0].metrics
    cells = first_row(run, view="speeds", robot="left")
    assert metrics["velocity_avg"] == pytest.approx(1.0)
    assert cells["mean_speed"] == pytest.approx(1.0)
    assert cells["path_length"] < 3.2
    assert first_row(run, view="speeds", robot="left", from_step=50)["mean_speed"] == 0


def test_a_long_stand_is_found(workspace: Path) -> None:
    text = PAIR.replace("behavior: {name: dash}}\n  - {name: right", "}\n  - {name: right")
    run = recorded(text=text)
    cells = first_row(run, view="speeds", robot="left")
    assert (cells["stood"], cells["stood_from_step"]) == (6.0, 1)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"robot": "lefd"}, "did you mean 'left'"),
        ({"fields": ["speeed"]}, "did you mean speed"),
        ({"from_step": 1000}, "step-out-of-range"),
        ({"from_step": 5, "to_step": 3}, "step-out-of-range"),
        ({"cursor": "x"}, "not a valid cursor"),
        ({"cursor": "9999"}, "beyond the last row"),
    ],
)
def test_wrong_questions_are_explained(pair: Run, options: dict[str, object], said: str) -> None:
    with pytest.raises(RunError, match=said):
        inspect_run(pair, **options)  # type: ignore[arg-type]


def test_artifacts_fit_and_go_on(pair: Run) -> None:
    for name in ARTIFACTS:
        assert artifact(pair, name)
    for name in ("scenario.yaml", "result.json"):
        text, whole = "", artifact(pair, name)
        while piece := artifact(pair, name, offset=len(text), most=100):
            text += piece
        assert text == whole
    text, whole = "", json.loads(artifact(pair, "replay.json"))
    while len(text) < whole["total"]:
        piece = artifact(pair, "replay.json", offset=len(text), most=5000)
        assert len(piece) <= 5000
        text += json.loads(piece)["data"]
    assert text == whole["data"]
    steps, start = [], 0
    while True:
        part = json.loads(artifact(pair, "trace.json", from_step=start, robot="left", most=2000))
        steps += [row["step"] for row in part["rows"]]
        if part["next_step"] is None:
            break
        start = part["next_step"]
    assert steps == list(range(pair.last_step + 1))
    table = artifact(pair, "trace.csv", every=10)
    rows = list(csv.reader(io.StringIO(table)))
    assert rows[0][:4] == ["step", "time", "robot", "x"]
    step, lines = 0, list[str]()
    while True:
        part = artifact(pair, "trace.csv", from_step=step, most=600)
        assert len(part) <= 600
        lines += [line for line in part.splitlines()[1:] if not line.startswith("#")]
        if "# next_step: " not in part:
            break
        step = int(part.rsplit(" ", 1)[1])
    assert lines == artifact(pair, "trace.csv").splitlines()[1:]
    whole = json.loads(artifact(pair, "events.json"))["events"]
    step, events = 0, list[Any]()
    while step is not None:
        some = json.loads(artifact(pair, "events.json", from_step=step, most=500))
        events += some["events"]
        step = some["next_step"]
    assert events == whole
    with pytest.raises(RunError, match="there are scenario"):
        artifact(pair, "trace.exe")


@pytest.mark.parametrize("name", ["events.json", "trace.json", "trace.csv"])
def test_who_is_not_there_is_told_of(pair: Run, name: str) -> None:
    with pytest.raises(RunError, match=r"lef'.*did you mean 'left'"):
        artifact(pair, name, robot="lef")
    with pytest.raises(RunError, match="step-out-of-range"):
        artifact(pair, name, from_step=99_999)


def test_a_run_can_be_replayed(crashed: Run) -> None:
    env = resimulate(crashed, 5)
    np.testing.assert_array_equal(env.simulation.pose, crashed.trace().pose[5])
    env.end()
    with pytest.raises(RunError, match="step-out-of-range"):
        resimulate(crashed, crashed.last_step + 1)


def test_a_replay_that_goes_otherwise_is_told(crashed: Run) -> None:
    path = crashed.folder / "scenario.yaml"
    path.write_text(path.read_text().replace("goal: [7, 1, 0]", "goal: [7, 2, 0]"))
    with pytest.raises(RunError, match="other poses"):
        resimulate(open_run(crashed.id), 5)


def test_the_command_line(crash: Path) -> None:
    def call(*words: str) -> str:
        result = CliRunner().invoke(app, words)
        assert result.exit_code == 0, result.output
        return result.stdout

    assert "no recorded runs here" in call("inspect")
    assert "recorded: irsim inspect crash-" in call("run", str(crash), "--seed", "3", "--record")
    run = open_run("last")
    assert run.id in call("inspect")
    result = run.folder / "result.json"
    kept = result.read_text()
    result.write_text('{"a": 1}')
    assert "unreadable" in call("inspect")
    result.write_text(kept)
    for view in VIEWS:
        shown = json.loads(call("inspect", run.id, "--view", view, "--json"))
        assert shown == json.loads(inspect_run(run, view=view).model_dump_json())
        assert run.id in call("inspect", "last", "--view", view)
    rows = list(csv.reader(io.StringIO(call("inspect", "last", "--csv"))))
    assert len(rows) == run.last_step + 2
    for piece in run.folder.glob("trace-*"):
        piece.unlink()
    (run.folder / "result.json").unlink()
    assert "interrupted -" in " ".join(call("inspect").split())
    kept = crash.parent / "kept"
    assert f"irsim inspect {kept}" in call("run", str(crash), "--record-to", str(kept))
    assert "collision" in call("inspect", str(kept))
    for words in (("inspect", "nothing-123456"), ("inspect", "last", "--view", "speed"), ("inspect", "..")):
        result = CliRunner().invoke(app, words)
        assert result.exit_code == 2


def test_all_objects_at_once(pair: Run) -> None:
    speeds = inspect_run(pair, view="speeds", robot="all")
    assert [row[0] for row in speeds.rows] == ["left", "right", "walker"]
    assert [row[0] for row in inspect_run(pair, view="speeds", robot="obstacles").rows] == ["walker"]
    assert [row[0] for row in inspect_run(pair, view="speeds", robot="walker, left").rows] == ["left", "walker"]
    rows = inspect_run(pair, robot="all", every=7, limit=None)
    assert [row[2] for row in rows.rows[:3]] == ["left", "right", "walker"]
    with pytest.raises(RunError, match="did you mean 'left'"):
        inspect_run(pair, robot="right, lefd")


def test_steps_beyond_the_end_of_the_episode_are_noted(pair: Run) -> None:
    assert not inspect_run(pair, to_step=pair.last_step).notes
    [note] = inspect_run(pair, to_step=pair.last_step + 50).notes
    assert note.startswith(f"step {pair.last_step + 50} is beyond the end of the episode")
    assert f"0 to {pair.last_step}" in note
