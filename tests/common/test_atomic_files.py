"""Files are written in one step: a reader sees the old content or the new one, and nothing else is left."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from irsim.common.files import TargetError, new_folder, replace_bytes, replacing, write_atomically, write_new


def stop(*_: object) -> None:
    raise KeyboardInterrupt


def test_a_write_that_is_stopped_leaves_what_was_there_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "result.json"
    target.write_text("old")
    monkeypatch.setattr(os, "replace", stop)
    for write in (lambda: replace_bytes(target, b"new"), lambda: write_atomically(target, "new")):
        with pytest.raises(KeyboardInterrupt):
            write()
    with pytest.raises(KeyboardInterrupt):
        write_new(tmp_path / "other.json", "new")
    assert [path.name for path in tmp_path.iterdir()] == ["result.json"]
    assert target.read_text() == "old"


def test_the_name_has_its_content_only_at_the_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target, seen = tmp_path / "result.json", []
    target.write_text("old")
    rename = os.replace

    def look(source: str, name: str) -> None:
        seen.append((target.read_text(), Path(source).read_text()))
        rename(source, name)

    monkeypatch.setattr(os, "replace", look)
    replace_bytes(target, b"n", b"ew")
    assert seen == [("old", "new")]
    assert target.read_text() == "new"


def test_an_encoder_that_fails_leaves_what_was_there_and_nothing_else(tmp_path: Path) -> None:
    target = tmp_path / "film.gif"
    target.write_text("old")

    def encode(fails: bool) -> None:
        with replacing(target) as temporary:
            assert temporary.suffix == ".gif"
            temporary.write_text("new")
            if fails:
                stop()

    with pytest.raises(KeyboardInterrupt):
        encode(fails=True)
    assert [path.name for path in tmp_path.iterdir()] == ["film.gif"]
    assert target.read_text() == "old"
    encode(fails=False)
    assert target.read_text() == "new"


def test_of_two_programs_that_write_a_new_file_one_is_told(tmp_path: Path) -> None:
    target = tmp_path / "run.csv"
    first = replacing(target, overwrite=False)
    first.__enter__().write_text("first", encoding="utf-8")
    with replacing(target, overwrite=False) as second:
        second.write_text("second", encoding="utf-8")
    with pytest.raises(TargetError, match="file-exists"):
        first.__exit__(None, None, None)
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("run.csv", "second")]


@pytest.mark.skipif(sys.platform != "linux", reason="needs a folder in which nobody can make files")
def test_a_file_that_cannot_be_written_is_named_as_the_user_did() -> None:
    for suffix in (".gif", ".mp4", ".png"):
        told = r"the file cannot be written .*; name another one"
        with pytest.raises(OSError, match=told) as raised, replacing(Path(f"/proc/x{suffix}")):
            pytest.fail("nothing is encoded")
        assert raised.value.filename == f"/proc/x{suffix}"
    with pytest.raises(OSError, match=r"/proc/x'$"), new_folder(Path("/proc/x")):
        pytest.fail("nothing is written")


def test_an_encoder_that_loses_its_file_names_it_as_the_user_did(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as raised, replacing(tmp_path / "x.gif") as temporary:
        temporary.open("rb")
    assert raised.value.filename == str(tmp_path / "x.gif")


@pytest.mark.skipif(sys.platform == "win32", reason="a pipe of POSIX")
def test_pipes_and_devices_are_written_to_and_stay(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_atomically(pipe, "text")
        assert os.read(reader, 100) == b"text"
        assert pipe.is_fifo()
    finally:
        os.close(reader)
    assert [path.name for path in tmp_path.iterdir()] == ["pipe"]
