"""Folders that are held: what is opened below them, and what is refused."""

from __future__ import annotations

import os
import pickle
import shutil
import sys
from pathlib import Path

import pytest

from irsim.common.held import Folder, elsewhere, hold, not_held

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="descriptors of POSIX")


@pytest.fixture
def root(tmp_path: Path) -> Path:
    root = tmp_path / "root"
    (root / "inner").mkdir(parents=True)
    (root / "inner" / "a.txt").write_text("a", encoding="utf-8")
    (tmp_path / "secret.txt").write_text("secret", encoding="utf-8")
    return root


def test_links_inside_are_followed_and_others_are_not(root: Path) -> None:
    (root / "in").symlink_to("inner")
    (root / "all").symlink_to(root / "inner" / "a.txt")
    (root / "out").symlink_to(root.parent)
    (root / "ring").symlink_to("ring")
    with hold(Folder(root)):
        assert (root / "in" / "a.txt").read_text(encoding="utf-8") == "a"
        assert Path("all").read_text(encoding="utf-8") == "a"
        assert Path("all").resolve() == root / "inner" / "a.txt"
        assert not (root / "out" / "secret.txt").exists()
        assert (root / "out").is_symlink()
        with pytest.raises(FileNotFoundError):
            (root / "out" / "new").write_text("x", encoding="utf-8")
        with pytest.raises(OSError, match="symbolic links"):
            Path("ring").read_bytes()
        with pytest.raises(PermissionError):
            Path("../secret.txt").read_bytes()
        shutil.rmtree(root / "out", ignore_errors=True)
    assert (root.parent / "secret.txt").exists()


def test_it_is_the_folder_of_the_start_wherever_its_name_leads(root: Path) -> None:
    folder = Folder(root)
    root.rename(root.with_name("moved"))
    root.symlink_to(root.parent)
    with hold(folder):
        assert sorted(os.listdir(root)) == ["inner"]
        assert [entry.name for entry in os.scandir(root / "inner") if entry.is_file()] == ["a.txt"]
        (root / "b.txt").write_text("b", encoding="utf-8")
        assert os.getcwd() == str(root)
        with not_held():
            assert (root / "secret.txt").exists()
    assert (root.parent / "moved" / "b.txt").exists()


def test_pipes_and_second_names_are_refused(root: Path) -> None:
    os.mkfifo(root / "pipe")
    os.link(root.parent / "secret.txt", root / "second.txt")
    with hold(Folder(root)):
        with pytest.raises(PermissionError):
            (root / "pipe").read_bytes()
        with pytest.raises(PermissionError):
            (root / "second.txt").write_text("x", encoding="utf-8")
    assert (root.parent / "secret.txt").read_text(encoding="utf-8") == "secret"


def test_libraries_that_open_files_themselves_write_elsewhere(root: Path) -> None:
    target = root / "inner" / "b"
    with hold(Folder(root)), elsewhere(target) as place:
        assert not place.is_relative_to(root)
        place.mkdir()
        (place / "c").write_text("c", encoding="utf-8")
    assert (target / "c").read_text(encoding="utf-8") == "c"


def test_the_calls_are_found_by_their_names(root: Path) -> None:
    with hold(Folder(root)):
        for call in (os.mkdir, os.open, os.listdir, os.rename, os.getcwd):
            assert pickle.loads(pickle.dumps(call)) is call
