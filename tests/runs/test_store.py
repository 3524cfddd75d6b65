"""The store keeps and deletes records, and survives processes that die and files that were changed."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.runs import RunError, list_runs, open_run
from irsim.runs.files import claim, replace_file
from irsim.runs.resimulation import resimulate
from irsim.runs.store import META, find_run, make_run_folder, mark_cancelled, prune, runs_folder, status_of, tidy
from tests.runs.conftest import ROOM, recorded

pytestmark = pytest.mark.one_python

ENDLESS = """\
world: {width: 100, height: 100, collision_mode: unobstructed}
robot:
  - number: 40
    kinematics: {name: diff}
    behavior: {name: dash, wander: true}
    distribution: {name: random, range_low: [1, 1, -3], range_high: [99, 99, 3]}
    shape: {name: circle, radius: 0.2}
    sensors: [{name: lidar2d, number: 50}]
"""


def made(workspace: Path, name: str, size: int = 10, age: float = 0.0) -> Path:
    """A run as the store sees it: so large, last used so many seconds ago."""
    folder = Path(make_run_folder(runs_folder(workspace, make=True), name))
    (folder / "trace-0000.npz").write_bytes(b"x" * size)
    (folder / META).write_text(json.dumps({"id": folder.name, "status": "finished"}))
    used = time.time() - age
    os.utime(folder / META, (used, used))
    return folder


def test_the_least_recently_used_make_room(workspace: Path) -> None:
    runs = [made(workspace, f"run-{n}", 1000, age=100 - n) for n in range(6)]
    gone = prune(runs_folder(workspace), quota=3500)
    assert sorted(gone) == sorted(folder.name for folder in runs[:3])
    assert [folder.exists() for folder in runs] == [False] * 3 + [True] * 3
    find_run(runs[3].name, workspace)
    assert prune(runs_folder(workspace), quota=2500) == [runs[4].name]


def test_old_ones_are_let_go_unless_they_are_written(workspace: Path) -> None:
    old, young, busy = (made(workspace, name, age=age) for name, age in (("a", 90_000), ("b", 80_000), ("c", 90_000)))
    held = claim(busy / "lock")
    assert prune(runs_folder(workspace)) == [old.name]
    held.release()
    assert prune(runs_folder(workspace)) == [busy.name]
    assert young.exists()


def test_looking_after_the_folder_takes_a_rest(workspace: Path) -> None:
    """However many runs there are, a short one does not wait for a look at all of them."""
    runs = runs_folder(workspace, make=True)
    tidy(runs)
    old = made(workspace, "a", age=90_000)
    tidy(runs)
    assert old.exists()
    mark, before = runs / ".tidied", time.time() - 10
    os.utime(mark, (before, before))
    tidy(runs)
    assert not old.exists()


def test_a_run_alone_may_exceed_the_quota_while_it_is_kept(workspace: Path) -> None:
    folder = made(workspace, "big", 1000)
    assert prune(runs_folder(workspace), quota=10, keep=folder.name) == []
    assert prune(runs_folder(workspace), quota=10) == [folder.name]
    assert [path.name for path in runs_folder(workspace).iterdir()] == [".clock"]


def test_leftovers_are_swept(workspace: Path) -> None:
    folder = made(workspace, "a")
    runs = runs_folder(workspace)
    half, trash, empty = folder / ".new-abc", runs / ".gone-b-123456-abc", runs / "b-123456"
    half.write_text("half")
    trash.mkdir()
    empty.mkdir()
    long_ago = time.time() - 1000
    for path in (half, empty):
        os.utime(path, (long_ago, long_ago))
    prune(runs)
    assert [path.exists() for path in (folder, half, trash, empty)] == [True, False, False, False]


@pytest.mark.parametrize("years", [40, -40])
def test_a_clock_that_jumps_deletes_no_new_run(workspace: Path, years: int) -> None:
    """As on a small computer that starts in 1970 and then learns the time."""
    runs, jump = runs_folder(workspace, make=True), years * 365 * 86400.0
    prune(runs)
    older, newer = (made(workspace, name, 1000, age=jump + age) for name, age in (("older", 9), ("newer", 5)))
    boot, up, now, *_ = (runs / ".clock").read_text().split("\n")
    (runs / ".clock").write_text(f"{boot}\n{up}\n{float(now) - jump}\n")
    assert prune(runs) == []
    last = made(workspace, "last", 1000)
    assert prune(runs, quota=2500) == [older.name]
    assert newer.is_dir()
    assert last.is_dir()
    assert made(workspace, "a", age=90_000).name in prune(runs), "a clock that goes on deletes old ones"


def test_runs_from_the_future_are_as_new_as_those_of_now(workspace: Path) -> None:
    future, now = made(workspace, "future", 1000, age=-1e9), made(workspace, "now", 1000)
    prune(runs_folder(workspace))
    assert abs((future / META).stat().st_mtime - time.time()) < 60
    find_run(now.name, workspace)
    assert prune(runs_folder(workspace), quota=1500) == [future.name]


def test_the_last_run_is_the_one_started_last_after_the_clock_was_set_back(
    workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(workspace)
    (workspace / "room.yaml").write_text(ROOM, encoding="utf-8")
    ids = [irsim.run("room.yaml", record=True, steps=1).run_id for _ in range(2)]
    ahead = time.time() + 365 * 86400
    for rank, run_id in enumerate(ids):
        for file in (workspace / ".irsim" / "runs" / str(run_id)).iterdir():
            os.utime(file, (ahead + rank, ahead + rank))
    os.utime(workspace / ".irsim" / "runs" / ".tidied", (ahead, ahead))
    last = irsim.run("room.yaml", record=True, steps=1).run_id
    assert find_run("last").name == last
    assert [run.id for run in list_runs()] == [last, *reversed(ids)]


def test_names_are_slugs() -> None:
    from irsim.runs.store import ID

    for stem in ("Crossing of 8 robots, é & more than that!", "...", "", "a" * 200, "../../x"):
        folder = Path(os.environ.get("TMPDIR", "/tmp"))
        made_one = Path(make_run_folder(folder, stem))
        made_one.rmdir()
        assert made_one.parent == folder
        assert ID.fullmatch(made_one.name)
        assert len(made_one.name) <= 31


def test_status(workspace: Path) -> None:
    folder = made(workspace, "a")
    assert status_of(folder) == "interrupted"
    held = claim(folder / "lock")
    assert status_of(folder) == "running"
    held.release()
    mark_cancelled(folder)
    assert status_of(folder) == "cancelled"
    (folder / "result.json").write_text("{}")
    assert status_of(folder) == "finished"


@pytest.mark.parametrize("where", [".irsim", ".irsim/runs"])
def test_nothing_is_written_or_read_through_links(
    workspace: Path, room: Path, tmp_path_factory: Any, where: str
) -> None:
    outside = tmp_path_factory.mktemp("outside")
    place = workspace / where
    place.parent.mkdir(exist_ok=True)
    place.symlink_to(outside, target_is_directory=True)
    with pytest.raises(RunError, match="path-outside-workspace"):
        irsim.run(room, record=True)
    with pytest.raises(RunError, match="path-outside-workspace"):
        open_run("room-123456", workspace)
    assert list(outside.iterdir()) == []


def test_links_in_a_run_are_not_followed(workspace: Path, room: Path, tmp_path_factory: Any) -> None:
    secret = tmp_path_factory.mktemp("outside") / "secret"
    secret.write_text("secret")
    run = recorded(room)
    folder = run.folder
    (folder / "scenario.yaml").unlink()
    (folder / "scenario.yaml").symlink_to(secret)
    with pytest.raises(RunError, match="unreadable-run"):
        _ = open_run(run.id).scenario_text
    (runs_folder(workspace) / "linked-123456").symlink_to(folder, target_is_directory=True)
    with pytest.raises(RunError, match="unknown-run"):
        open_run("linked-123456", workspace)


@pytest.mark.parametrize("name", ["run.json", "trace-0000.npz", "result.json", "resolved.json"])
def test_changed_files_are_told(room: Path, name: str) -> None:
    run_id = recorded(room).id
    path = runs_folder() / run_id / name
    content = path.read_bytes()
    rng = random.Random(name)
    texts = (b"", b"[1, 2", b"[7]", b'{"a": 1}')
    for damaged in (*texts, content[: len(content) // 2], rng.randbytes(500), b"\xff" + content):
        path.write_bytes(damaged)
        with pytest.raises(RunError, match="unreadable-run"):
            read_all(run_id)
    path.write_bytes(content)
    open_run(run_id).trace()
    list_runs()


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("trace-0000.npz", None, "the trace of run .* is missing"),
        ("scenario.yaml", " \n", "has no scenario.yaml, or an empty one"),
        ("run.json", "[]", "it is not a mapping"),
        ("run.json", {"id": 10**30}, "see its key 'id'"),
    ],
)
def test_what_a_run_lacks_is_said(room: Path, name: str, text: Any, message: str) -> None:
    run_id = recorded(room).id
    path = runs_folder() / run_id / name
    changed = json.dumps({**json.loads(path.read_text()), **text}) if isinstance(text, dict) else text
    path.unlink() if changed is None else path.write_text(changed)
    with pytest.raises(RunError, match=f"unreadable-run: .*{message}"):
        resimulate(open_run(run_id)).end()


def read_all(run_id: str) -> None:
    run = open_run(run_id)
    _ = run.trace(), run.events, run.result, run.resolved


def test_pickles_and_packed_arrays_are_refused(room: Path) -> None:
    run_id = recorded(room).id
    path = runs_folder() / run_id / "trace-0000.npz"
    with np.load(path) as file:
        arrays = dict(file)
    about = arrays.pop("piece.json")

    def refused(save: Callable[..., None], **changes: Any) -> None:
        save(path, **{**arrays, **changes})
        with zipfile.ZipFile(path, "a") as archive:
            archive.writestr("piece.json", about)
        with pytest.raises(RunError, match="unreadable-run"):
            open_run(run_id).trace()

    refused(np.savez, pose=np.array([object()]))
    refused(np.savez_compressed, more=np.zeros(10**7))


@pytest.mark.parametrize(
    "change",
    [
        {"rows": 2**40},
        {"rows": 0},
        {"first": -1},
        {"first": 1e999},
        {"flag_rows": [5, 3]},
        {"goal_rows": []},
        {"goal_rows": {}},
        {"scan_rows": 7},
        {"movers": [10**30]},
        {"movers": [-1]},
        {"movers": None},
        {"events": None},
        {"events": [{}]},
    ],
)
def test_pieces_that_tell_nonsense_are_refused(room: Path, change: dict[str, Any]) -> None:
    run_id = recorded(room).id
    path = runs_folder() / run_id / "trace-0000.npz"
    with zipfile.ZipFile(path) as archive:
        content = {name: archive.read(name) for name in archive.namelist()}
    content["piece.json"] = json.dumps({**json.loads(content["piece.json"]), **change}).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in content.items():
            archive.writestr(name, data)
    with pytest.raises(RunError, match="unreadable-run"):
        read_all(run_id)


def test_a_run_with_a_piece_missing_is_refused(room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as small:
        small.setattr("irsim.runs.recorder._PIECE_BYTES", 1)
        small.setattr("irsim.episodes.episode._CHUNK_STEPS", 7)
        run_id = recorded(room, seed=4).id
    read_all(run_id)
    folder = runs_folder() / run_id
    (folder / "trace-0002.npz").rename(folder / "kept")
    with pytest.raises(RunError, match=r"unreadable-run: piece 0002 .*Fix: run it again"):
        read_all(run_id)
    (folder / "trace-0003.npz").rename(folder / "trace-0002.npz")
    (folder / "kept").rename(folder / "trace-0003.npz")
    with pytest.raises(RunError, match="do not follow each other"):
        read_all(run_id)


@pytest.mark.parametrize("pieces", [True, False])
def test_files_are_whole_however_little_the_system_takes_at_once(
    workspace: Path, pieces: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    write = os.write
    if pieces:
        monkeypatch.setattr(os, "writev", lambda file, parts: write(file, b"".join(parts)[:3]), raising=False)
    else:
        monkeypatch.delattr(os, "writev", raising=False)
    monkeypatch.setattr(os, "write", lambda file, data: write(file, data[:2]))
    replace_file(workspace / "file", b"one, ", memoryview(b"two"), b"", b" and three")
    assert (workspace / "file").read_bytes() == b"one, two and three"
    assert [path.name for path in workspace.iterdir()] == ["file"]


def test_a_large_run_just_used_stays_and_older_ones_go(workspace: Path) -> None:
    old, older = made(workspace, "old", 1000, age=200), made(workspace, "older", 1000, age=300)
    large = made(workspace, "large", 5000, age=10)
    assert sorted(prune(runs_folder(workspace), quota=5500)) == sorted([old.name, older.name])
    assert large.is_dir()


def test_what_only_leads_to_a_run_is_none(room: Path) -> None:
    run_id = recorded(room).id
    path = runs_folder() / run_id / META
    path.rename(room.parent / "elsewhere.json")
    path.symlink_to(room.parent / "elsewhere.json")
    assert list_runs() == []
    with pytest.raises(RunError, match=r"there are no runs here.*`irsim run FILE --record`"):
        open_run(run_id)


def endless(workspace: Path) -> subprocess.Popen[bytes]:
    """A process that records a run without end."""
    code = (
        "import irsim.runs.recorder as r, irsim\n"
        "r._PERIOD = 0.01\n"
        f"irsim.run(text={ENDLESS!r}, seed=1, steps=10**7, record=True)\n"
    )
    return subprocess.Popen([sys.executable, "-c", code], cwd=workspace, stderr=subprocess.DEVNULL)


@pytest.mark.usefixtures("interruptible")
def test_a_run_that_is_being_written_can_be_read(workspace: Path) -> None:
    process = endless(workspace)
    try:
        run = first_run(workspace)
        assert run.status == "running"
        steps = run.trace().step.tolist()  # once: it goes on meanwhile
        assert steps == list(range(len(steps)))
        process.send_signal(signal.SIGINT)
        process.wait(20)
        assert run.status == "cancelled"
        assert run.result is None
    finally:
        process.kill()
        process.wait()


@pytest.mark.parametrize(
    "delay", [0.02, 0.15, *(pytest.param(delay, marks=pytest.mark.slow) for delay in (0.0, 0.07, 0.4))]
)
def test_what_a_killed_process_leaves_is_whole(workspace: Path, delay: float) -> None:
    process = endless(workspace)
    run = first_run(workspace)
    time.sleep(delay)
    process.kill()
    process.wait()
    assert run.status == "interrupted"
    trace, events = run.trace(), run.events
    assert trace.step.tolist() == list(range(len(trace)))
    assert np.isfinite(trace.pose).all()
    assert all(event.step <= trace.step[-1] for event in events)
    assert run.resolved["objects"]
    later = time.time() + 1000
    leftovers = [path for path in run.folder.iterdir() if path.name.startswith(".")]
    for path in leftovers:
        os.utime(path, (later - 2000, later - 2000))
    prune(runs_folder(workspace))
    assert not [path for path in run.folder.iterdir() if path.name.startswith(".")]
    assert open_run(run.id, workspace).trace().step[-1] == trace.step[-1]


def first_run(workspace: Path) -> Any:
    """The run that a process has begun, once it has a first piece."""
    end = time.monotonic() + 30
    while time.monotonic() < end:
        runs = list_runs(workspace)
        if runs and runs[0].last_step >= 0:
            return runs[0]
        time.sleep(0.005)
    raise AssertionError("no run has begun")


def test_a_run_that_is_let_go_meanwhile_is_unknown(workspace: Path, room: Path) -> None:
    run = recorded(room)
    assert prune(runs_folder(workspace), age=-1) == [run.id]
    with pytest.raises(RunError, match="has been deleted"):
        run.trace()
    assert run.status == "interrupted"
