"""Which files that a file names may be read."""

from __future__ import annotations

from pathlib import Path

import pytest

from irsim.bridges.maps.named_files import lies_in, readable, with_root


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    """Two folders beside each other; the first has a file of its own, a link out of it, and a link within it."""
    own, other = tmp_path / "own", tmp_path / "other"
    for folder in (own / "meshes", other):
        folder.mkdir(parents=True)
        (folder / "box.stl").touch()
    (own / "out.stl").symlink_to(other / "box.stl")
    (own / "in.stl").symlink_to(own / "meshes" / "box.stl")
    return own, other


def test_files_below_the_folder_are_read(folders: tuple[Path, Path]) -> None:
    own, _ = folders
    box = own.resolve() / "meshes" / "box.stl"
    for name in ("meshes/box.stl", "in.stl", "meshes/../in.stl", "../own/in.stl"):
        assert readable(own / name, [own, None]) == box
    assert readable(own, [own]) == own.resolve()


def test_files_elsewhere_are_read_below_the_root_only(folders: tuple[Path, Path]) -> None:
    own, other = folders
    for name in ("../other/box.stl", "out.stl", str(other / "box.stl")):
        assert readable(own / name, [own, None]) is None
        assert readable(own / name, [own, other]) == other.resolve() / "box.stl"


def test_what_is_not_there_is_not_read(folders: tuple[Path, Path]) -> None:
    own, other = folders
    for name in ("no.stl", "n" * 5000, "in.stl/box.stl"):
        assert readable(own / name, [own]) is None
    assert lies_in(own / "no.stl", [own])
    assert not lies_in(own.with_name("ownership"), [own])
    assert not lies_in(own, [None, other])


def test_the_advice_names_the_folder_that_holds_both(folders: tuple[Path, Path]) -> None:
    own, other = folders
    assert with_root("x", own, other / "box.stl") == (
        f"give --root {own.parent.resolve()} if its files there may be read, or x"
    )
    assert with_root("x", own, Path("/box.stl")) == "x"
