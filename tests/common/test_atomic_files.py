"""Files are written in one step: a reader sees the old content or the new one, and nothing else is left."""

from __future__ import annotations

import os
import sys
import threading
from pathlib import Path

import pytest
from typer.testing import CliRunner

from irsim.cli.app import app
from irsim.common.files import TargetError, new_folder, replace_bytes, replacing, write_atomically, write_new
from tests.disks import here

__all__ = ["here"]


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


@pytest.mark.skipif(sys.platform != "linux", reason="needs /proc, a folder in which even root cannot create files")
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


def _encode(target: Path) -> None:
    with replacing(target) as temporary:
        assert temporary.suffix == target.suffix
        temporary.write_text("text")


def _encode_anew(target: Path) -> None:
    with replacing(target, overwrite=False) as temporary:
        temporary.write_text("text")


WRITERS = {
    "write_atomically": lambda target: write_atomically(target, "text"),
    "write_new": lambda target: write_new(target, "text"),
    "replace_bytes": lambda target: replace_bytes(target, b"te", b"xt", mode=None),
    "replacing": _encode,
    "replacing anew": _encode_anew,
}


@pytest.mark.skipif(sys.platform == "win32", reason="a pipe of POSIX")
@pytest.mark.parametrize("name", WRITERS)
def test_pipes_and_devices_are_written_to_and_stay(name: str, tmp_path: Path) -> None:
    pipe, link = tmp_path / "pipe.csv", tmp_path / "link.csv"
    os.mkfifo(pipe)
    link.symlink_to(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        for target in (pipe, link):
            WRITERS[name](target)
            assert os.read(reader, 100) == b"text"
    finally:
        os.close(reader)
    assert pipe.is_fifo()
    assert link.is_symlink()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["link.csv", "pipe.csv"]


@pytest.mark.skipif(sys.platform == "win32", reason="a pipe of POSIX")
def test_records_take_the_place_of_a_pipe(tmp_path: Path) -> None:
    """The file of a run has one name, and a pipe of that name, which another program has put there, stops no writer."""
    os.mkfifo(tmp_path / "run.json")
    replace_bytes(tmp_path / "run.json", b"{}")
    assert (tmp_path / "run.json").read_bytes() == b"{}"


@pytest.mark.skipif(sys.platform == "win32", reason="a pipe of POSIX")
@pytest.mark.usefixtures("here")
def test_a_folder_takes_no_place_of_a_pipe(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for force in ((), ("--force",)):
        done = CliRunner().invoke(app, ["export", "last", "--to", "colmap", "-o", str(tmp_path / "pipe"), *force])
        assert "file-exists" in done.stderr, done.output
    assert (tmp_path / "pipe").is_fifo()


@pytest.mark.skipif(sys.platform == "win32", reason="a pipe of POSIX")
@pytest.mark.parametrize(
    ("command", "begins"),
    [
        ("render room.yaml -o {pipe}.png", b"\x89PNG"),
        ("run room.yaml --export {pipe}.csv", b"run,step,"),
        ("export last --to csv -o {pipe}.csv", b"run,step,"),
        ("schema -o {pipe}.json", b"{"),
        ("new maze -o {pipe}.yaml", b""),
        ("replay last -o {pipe}.html", b"<!"),
        ("map import hall.yaml -o {pipe}.yaml", b"#"),
    ],
)
@pytest.mark.usefixtures("here")
def test_commands_write_to_pipes(command: str, begins: bytes, tmp_path: Path) -> None:
    pipe = tmp_path / f"pipe{command[command.index('}') + 1 :].split()[0]}"
    os.mkfifo(pipe)
    content: list[bytes] = []
    reader = threading.Thread(target=lambda: content.append(pipe.read_bytes()), daemon=True)
    reader.start()
    done = CliRunner().invoke(app, command.format(pipe=tmp_path / "pipe").split())
    reader.join(5)
    assert done.exit_code == 0, done.output
    assert content[0].startswith(begins)
    assert pipe.is_fifo()
    assert not [path.name for path in tmp_path.iterdir() if path.name.startswith(".") and path.name != ".irsim"]
