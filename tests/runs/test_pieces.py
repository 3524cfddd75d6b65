"""Pieces of a run are written while the simulation goes on: nothing is lost, mixed up or kept back."""

from __future__ import annotations

import threading
import time
import zipfile
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.runs import RunError, list_runs, open_run
from irsim.runs import recorder as recorder_module
from irsim.runs.chunks import PieceWriter
from irsim.runs.files import replace_file
from tests.runs.conftest import recorded
from tests.runs.test_trace import assert_same


@pytest.fixture
def small_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    """A piece after every five steps."""
    monkeypatch.setattr("irsim.runs.recorder._PIECE_BYTES", 1)
    monkeypatch.setattr("irsim.episodes.episode._CHUNK_STEPS", 5)


def recorder_threads() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name == "irsim-recorder"]


def test_a_slow_disk_changes_nothing(room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = recorded(room, seed=4, steps=40)
    monkeypatch.setattr("irsim.runs.recorder._PIECE_BYTES", 1)
    monkeypatch.setattr("irsim.episodes.episode._CHUNK_STEPS", 5)

    def slow(target: str | Path, *parts: Any) -> None:
        time.sleep(0.01 if "trace-" in str(target) else 0)
        replace_file(target, *parts)

    monkeypatch.setattr(recorder_module, "replace_file", slow)
    run = recorded(room, seed=4, steps=40)
    assert sum(name.startswith("trace-") for name in run.files()) > 5
    assert_same(run.trace(), whole.trace())
    assert run.events == whole.events
    assert recorder_threads() == []


@pytest.mark.usefixtures("small_pieces")
def test_a_piece_that_cannot_be_written_ends_the_run(room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(target: str | Path, *parts: Any) -> None:
        if Path(target).name == "trace-0002.npz":
            raise RunError("file-access", f"'{target}' cannot be written: No space left on device")
        replace_file(target, *parts)

    monkeypatch.setattr(recorder_module, "replace_file", full)
    with pytest.raises(RunError, match="No space left on device"):
        irsim.run(room, seed=4, steps=100, record=True)
    assert recorder_threads() == []
    assert not list(Path(".irsim/runs").glob("*/trace-0002.npz"))
    assert not list(Path(".irsim/runs").glob("*/result.json"))


@pytest.mark.usefixtures("small_pieces")
def test_a_failing_program_leaves_what_was_recorded(room: Path) -> None:
    calls: list[int] = []

    @irsim.register_behavior("diff", "test_pieces_fail")
    def fails(ego_object: object, external_objects: object, **_: object) -> list[float]:
        calls.append(1)
        if len(calls) > 23:
            raise ValueError("enough")
        return [1.0, 0.0]

    room.write_text(room.read_text().replace("{name: dash}", "{name: test_pieces_fail}"))
    with pytest.raises(ValueError, match="enough"):
        irsim.run(room, seed=0, record=True)
    assert recorder_threads() == []
    assert open_run("last").trace().step.tolist() == list(range(24))


def test_a_folder_of_ones_own_has_every_scan(room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = recorded(room, seed=4, steps=30)
    monkeypatch.setattr("irsim.runs.recorder._MAX_SCANS_BYTES", 500)
    monkeypatch.setattr("irsim.runs.recorder._MAX_TRACE_BYTES", 500)
    monkeypatch.setattr("irsim.runs.recorder._MAX_SCAN_BYTES", 1)
    monkeypatch.setattr("irsim.runs.recorder._PIECE_BYTES", 300)
    monkeypatch.setattr("irsim.episodes.episode._CHUNK_STEPS", 5)
    assert irsim.run(room, seed=4, steps=30, record="kept").notes == []
    run = open_run("kept")
    assert len([name for name in run.files() if name.startswith("trace-")]) > 2
    assert_same(run.trace(), whole.trace())


def test_pieces_of_many_objects_have_few_rows(room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim.runs.recorder._MAX_PIECE_NUMBERS", 2 * 3 * 10)
    monkeypatch.setattr("irsim.episodes.episode._CHUNK_STEPS", 5)
    run = recorded(room, seed=4, steps=30)
    lengths = [len(block) for block in map(run._piece, run._pieces("trace"))]
    assert max(lengths) <= 15
    assert sum(lengths) == 31


def test_the_writer_raises_once_and_goes_on() -> None:
    done: list[int] = []

    def fail() -> None:
        raise OSError("broken")

    writer = PieceWriter()
    writer.wait()
    writer.submit(fail)
    with pytest.raises(OSError, match="broken"):
        writer.wait()
    writer.submit(lambda: done.append(1))
    writer.wait()
    assert done == [1]


def test_a_piece_is_written_even_if_an_interrupt_comes_while_its_thread_is_started(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    done: list[int] = []

    def interrupted(self: Thread) -> None:
        raise KeyboardInterrupt

    writer = PieceWriter()
    monkeypatch.setattr(Thread, "start", interrupted)
    with pytest.raises(KeyboardInterrupt):
        writer.submit(lambda: done.append(1))
    writer.wait()
    writer.wait()
    assert done == [1]


def test_a_run_that_is_cancelled_while_a_piece_begins_is_cancelled(room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(self: PieceWriter) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(PieceWriter, "wait", interrupted)
    with pytest.raises(KeyboardInterrupt):
        irsim.run(room, seed=0, record=True)
    assert list_runs()[0].status == "cancelled"


@pytest.mark.usefixtures("small_pieces")
def test_runs_with_python_behaviors_have_every_row(room: Path) -> None:
    @irsim.register_behavior("diff", "test_pieces_turn")
    def turns(ego_object: object, external_objects: object, **_: object) -> list[float]:
        return [0.5, 0.3]

    room.write_text(room.read_text().replace("{name: dash}", "{name: test_pieces_turn}"))
    trace = recorded(room, steps=43).trace()
    np.testing.assert_array_equal(trace.step, np.arange(44))
    np.testing.assert_allclose(trace.pose[:, 0, 2], 0.03 * np.arange(44), atol=1e-12)


def test_a_piece_that_was_compressed_is_not_read(room: Path) -> None:
    run = recorded(room, seed=4, steps=5)
    [piece] = run.folder.glob("trace-*")
    with zipfile.ZipFile(piece) as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(piece, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in entries.items():
            archive.writestr(name, content)
        archive.writestr("zeros", bytes(10**6))
    with pytest.raises(RunError, match="encrypted or compressed"):
        open_run(run.id).trace()
