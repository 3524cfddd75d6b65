"""Recording a run and reading it back."""

from __future__ import annotations

import json
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pydantic_core import from_json, to_json
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.env import Env
from irsim.runs import RunError, list_runs, open_run
from irsim.runs.artifacts import artifact
from irsim.runs.inspection import VIEWS, inspect_run
from irsim.runs.resimulation import resimulate
from irsim.simulation.trace import Trace, record
from tests.runs.conftest import recorded
from tests.runs.test_trace import assert_same


def test_a_recorded_run_reads_back_bit_for_bit(room: Path) -> None:
    result = irsim.run(room, seed=4, record=True)
    plain = irsim.run(room, seed=4)
    assert result.run_id is not None
    assert result.model_dump(exclude={"run_id", "artifacts"}) == plain.model_dump(exclude={"run_id", "artifacts"})
    run = open_run(result.run_id)
    env = Env(room, seed=4, headless=True, log_level="ERROR")
    assert_same(run.trace(), in_single_precision(record(env.simulation, result.steps, scans=True)))
    assert run.status == "finished"
    assert run.result == result
    assert run.events == env.events
    assert run.scenario_text == room.read_text()
    assert run.last_step == result.steps
    assert {run.meta[key] for key in ("seed", "scenario", "horizon")} == {4, str(room), 200}
    assert all(Path(path).is_file() for path in result.artifacts.values())
    assert (room.parent / ".irsim" / ".gitignore").read_text() == "*\n"


def test_flags_keep_their_meaning(crash: Path) -> None:
    crash.write_text(crash.read_text().replace("world: {", "world: {collision_mode: unobstructed, ", 1))
    run = recorded(crash, seed=4)
    live = record(Env(crash, seed=4, headless=True, log_level="ERROR").simulation, run.last_step, scans=True)
    assert live.collided.any()
    assert not live.stopped.any()
    for name in ("arrived", "collided", "stopped"):
        np.testing.assert_array_equal(getattr(run.trace(), name), getattr(live, name))


def in_single_precision(trace: Trace) -> Trace:
    """With controls as they are kept."""
    return replace(trace, control=trace.control.astype(np.float32).astype(np.float64))


def test_what_a_run_says_of_its_scenario_is_plain(room: Path) -> None:
    run = recorded(room)
    rover, crate = run.resolved["objects"]
    assert (rover["name"], rover["role"]) == ("rover", "robot")
    assert (rover["state"][:3], rover["goals"]) == ([1, 1, 0], [[4, 3, 0]])
    assert crate["shape"]["radius"] == 0.5
    assert run.resolved["radius"] == [0.3, 0.5]
    assert run.resolved["world"]["width"] == 8
    json.dumps(run.resolved, allow_nan=False)


def test_what_a_run_says_of_its_objects_is_everything(room: Path) -> None:
    run = recorded(room)
    for told, item in zip(run.resolved["objects"], Env(room, headless=True).scenario.objects, strict=True):
        whole = from_json(to_json(replace(item, state=told["state"], goals=told["goals"]), inf_nan_mode="strings"))
        assert told == whole


def test_what_many_objects_have_in_common_is_kept_once(workspace: Path) -> None:
    sizes = []
    for number in (1, 100):
        robots = {"number": number, "distribution": {"name": "circle", "radius": 20, "center": [25, 25]}}
        scenario = {"world": {"width": 50, "height": 50}, "robot": {**robots, "kinematics": {"name": "diff"}}}
        run = recorded(text=json.dumps(scenario), steps=1)
        assert [item["kinematics"]["name"] for item in run.resolved["objects"]] == ["diff"] * number
        sizes.append((run.folder / "resolved.json").stat().st_size)
    assert sizes[1] < 100 * sizes[0] / 4


@pytest.mark.parametrize(
    "world",
    ["obstacle_map: {name: perlin, resolution: 0.2}", "obstacle_map: {name: ros, path: floor.yaml}, boundary: walls"],
)
def test_two_records_of_a_map_say_the_same(workspace: Path, world: str) -> None:
    (workspace / "floor.yaml").write_text("image: floor.png\nresolution: 0.1\norigin: [0, 0, 0]\n")
    Image.new("L", (40, 40), 254).save(workspace / "floor.png")
    (workspace / "map.yaml").write_text(f"world: {{width: 4, height: 4, time_limit: 1, {world}}}\n")
    texts = [(recorded(workspace / "map.yaml", seed=1).folder / "resolved.json").read_bytes() for _ in range(2)]
    assert texts[0] == texts[1]
    assert b"object at 0x" not in texts[0]


def test_a_piece_of_the_trace_is_an_archive_for_everybody(room: Path) -> None:
    result = irsim.run(room, seed=4, record=True)
    path = open_run(str(result.run_id)).folder / "trace-0000.npz"
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
    with np.load(path, allow_pickle=False) as arrays:
        about = json.loads(arrays["piece.json"])
        assert (about["first"], about["rows"]) == (0, result.steps + 1)
        assert arrays["pose"].shape == (result.steps + 1, 1, 3)
        assert len(about["events"]) == len(result.events)


def test_texts_are_recorded_too(workspace: Path, room: Path) -> None:
    result = irsim.run(text=room.read_text(), seed=1, record=True)
    assert str(result.run_id).startswith("scenario-")
    assert [run.id for run in list_runs()] == [result.run_id]
    assert open_run("last").meta["scenario"] is None


def test_many_pieces_are_one_trace(room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as small:
        small.setattr("irsim.runs.recorder._PIECE_BYTES", 1)
        small.setattr("irsim.episodes.episode._CHUNK_STEPS", 7)
        many = recorded(room, seed=4)
    assert sum(name.startswith("trace-") for name in many.files()) > 5
    one = open_run(str(irsim.run(room, seed=4, record=True).run_id), room.parent)
    assert_same(many.trace(), one.trace())
    assert many.events == one.events


def test_scans_are_kept_as_long_as_there_is_room(room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = recorded(room, seed=4, steps=30).trace()
    [(key, ranges)] = whole.ranges.items()
    assert len(ranges) == len(whole) == 31
    monkeypatch.setattr("irsim.runs.recorder._MAX_SCANS_BYTES", 4 * ranges.shape[1] * 17)
    for kept in (None, "film.gif"):  # inside the core, and step by step
        result = irsim.run(room, seed=4, steps=30, record=True, save=kept)
        assert result.notes == ["scans recorded until step 16 of 30 (too large)"]
        run = open_run(str(result.run_id))
        np.testing.assert_array_equal(run.trace().ranges[key], ranges[:17])
        np.testing.assert_array_equal(run.trace().pose, whole.pose)
        table = inspect_run(run, robot="rover", fields=["nearest_hit"], every=1, limit=None)
        told = [row[-1] for row in table.rows]
        assert "not recorded" not in told[:17]
        assert told[17:] == ["not recorded"] * 14
        assert table.notes == result.notes
        told = json.loads(artifact(run, "trace.json", robot="rover", from_step=16, to_step=17))
        assert [row["ranges"][key] is None for row in told["rows"]] == [False, True]
        assert irsim.replay(run).scans == "computed"
    monkeypatch.setattr("irsim.runs.recorder._MAX_SCAN_BYTES", 1)
    assert irsim.run(room, seed=4, steps=30, record=True).notes == ["scans not recorded (too large)"]


def test_a_record_that_ends_early_says_so_everywhere(room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.runs.recorder._PIECE_BYTES", 1)
    monkeypatch.setattr("irsim.runs.recorder._MAX_TRACE_BYTES", 2000)
    monkeypatch.setattr("irsim.episodes.episode._CHUNK_STEPS", 5)
    console = CliRunner()
    shown = console.invoke(app, ["run", str(room), "--seed", "4", "--steps", "30", "--record"]).stdout
    run = open_run("last")
    until = run.last_step
    assert 0 < until < 30
    note = f"recorded until step {until} of 30: size limit"
    assert f"note: {note}" in shown
    assert run.result is not None
    assert run.result.notes == [note]
    for view in VIEWS:
        assert inspect_run(run, view=view).notes[0] == note
        assert f"note: {note}" in console.invoke(app, ["inspect", "last", "--view", view]).stdout
    with pytest.raises(RunError, match=f"no steps from 29 on. Fix: it has the steps 0 to {until}; {note}"):
        inspect_run(run, from_step=29)
    with pytest.raises(RunError, match=f"no step 29. Fix: it has the steps 0 to {until}; {note}"):
        resimulate(run, 29)
    assert irsim.replay(run).notes == [note]
    assert f"note: {note}" in console.invoke(app, ["replay", "last"]).stdout


def test_a_folder_of_ones_own(room: Path, tmp_path: Path) -> None:
    target = tmp_path / "kept" / "first"
    result = irsim.run(room, seed=4, record=target)
    assert open_run(target).result == result
    assert not (tmp_path / ".irsim").exists()
    with pytest.raises(RunError, match="file-exists"):
        irsim.run(room, seed=4, record=target)


def test_drawn_runs_are_recorded_too(room: Path, tmp_path: Path) -> None:
    drawn = irsim.run(room, seed=4, steps=12, record=True, save=tmp_path / "film.gif")
    plain = irsim.run(room, seed=4, steps=12, record=True)
    assert_same(open_run(str(drawn.run_id)).trace(), open_run(str(plain.run_id)).trace())


def test_a_failing_run_is_readable_until_then(room: Path) -> None:
    @irsim.register_behavior("diff", "test_record_fails")
    def fails(ego_object: object, external_objects: object, **kwargs: object) -> object:
        fails_at.append(1)
        return np.zeros((2, 1)) if len(fails_at) < 6 else None

    fails_at: list[int] = []
    room.write_text(room.read_text().replace("{name: dash}", "{name: test_record_fails}"))
    with pytest.raises(irsim.IrsimError):
        irsim.run(room, seed=0, record=True)
    run = open_run("last")
    assert run.status == "interrupted"
    assert run.result is None
    assert run.trace().step.tolist() == [0, 1, 2, 3, 4, 5]


def test_last_is_the_run_begun_last_whatever_was_looked_at_since(room: Path) -> None:
    with pytest.raises(RunError, match="there are no runs here"):
        open_run("room-123456")
    ids = [str(irsim.run(room, seed=n, steps=1, record=True).run_id) for n in range(7)]
    inspect_run(ids[0])
    assert open_run("last").id == ids[-1]
    assert [run.id for run in list_runs()] == ids[::-1]
    with pytest.raises(RunError, match=f"unknown-run: .*recent ones are {', '.join(ids[:1:-1])}"):
        open_run("room-123456")
    with pytest.raises(RunError):
        open_run("../../room")


def test_a_full_disk_is_told(room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*args: object, **kwargs: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("irsim.runs.files.os.replace", full)
    with pytest.raises(RunError, match=r"disk-full: .*No space left"):
        irsim.run(room, seed=0, record=True)
    assert not list(room.parent.rglob(".new-*"))
