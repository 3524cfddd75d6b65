"""The compiler launcher of ``.ci/run``: it must never hand out a wrong object."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

LAUNCHER = Path(__file__).resolve().parents[2] / ".ci/compile_once.py"
COMPILER = shutil.which("g++") or shutil.which("clang++")

pytestmark = pytest.mark.skipif(os.name == "nt" or COMPILER is None, reason="needs a compiler with options of gcc")


class Project:
    """A source and a header, in a folder of their own."""

    def __init__(self, folder: Path, objects: Path, body: str = "return VALUE;", value: str = "1") -> None:
        (folder / "include").mkdir(parents=True)
        (folder / "include" / "value.hpp").write_text(f"#define VALUE {value}\n", encoding="utf-8")
        (folder / "f.cpp").write_text(f'#include "value.hpp"\nint f() {{ {body} }}\n', encoding="utf-8")
        self.folder, self.objects = folder, objects

    def build(self, *options: str) -> int:
        """Compile as CMake does; returns the exit status."""
        command = [str(COMPILER), f"-I{self.folder / 'include'}", *options, "-MD", "-MT", "f.o", "-MF", "f.o.d"]
        launcher = [sys.executable, "-IS", str(LAUNCHER), str(self.objects)]
        call = [*launcher, *command, "-o", "f.o", "-c", str(self.folder / "f.cpp")]
        return subprocess.run(call, cwd=self.folder, capture_output=True, check=False).returncode

    @property
    def object(self) -> bytes:
        return (self.folder / "f.o").read_bytes()


@pytest.fixture
def objects(tmp_path: Path) -> Path:
    folder = tmp_path / "objects"
    folder.mkdir()
    return folder


def test_the_same_source_elsewhere_is_copied(tmp_path: Path, objects: Path) -> None:
    first, second = Project(tmp_path / "a", objects), Project(tmp_path / "b" / "c", objects)
    assert first.build("-O1") == 0
    [known] = objects.iterdir()
    assert known.read_bytes() == first.object
    known.write_bytes(b"marked")
    assert second.build("-O1") == 0
    assert second.object == b"marked"
    assert str(second.folder / "include" / "value.hpp") in (second.folder / "f.o.d").read_text(encoding="utf-8")


def test_headers_options_and_sources_count(tmp_path: Path, objects: Path) -> None:
    first = Project(tmp_path / "a", objects)
    others = [
        (Project(tmp_path / "b", objects, value="2"), ()),
        (Project(tmp_path / "c", objects, body="return VALUE + 1;"), ()),
        (Project(tmp_path / "d", objects), ("-O2",)),
        (Project(tmp_path / "e", objects), ("-DVALUE=1", "-w")),
    ]
    assert first.build() == 0
    for count, (other, options) in enumerate(others, start=2):
        assert other.build(*options) == 0
        assert len([*objects.iterdir()]) == count


def test_where_the_standard_is_named_does_not_count(tmp_path: Path, objects: Path) -> None:
    assert Project(tmp_path / "a", objects).build("-std=c++17", "-O1", "-Wall") == 0
    assert Project(tmp_path / "b", objects).build("-O1", "-Wall", "-std=c++17") == 0
    assert len([*objects.iterdir()]) == 1
    assert Project(tmp_path / "c", objects).build("-O1", "-Wall", "-std=c++14") == 0
    assert len([*objects.iterdir()]) == 2


@pytest.mark.parametrize("option", ["-g", "-g1", "-fsanitize=undefined", "-fsanitize=address,undefined"])
def test_what_carries_positions_is_always_compiled(tmp_path: Path, objects: Path, option: str) -> None:
    project = Project(tmp_path / "a", objects)
    assert project.build(option) == 0
    assert project.object
    assert [*objects.iterdir()] == []


@pytest.mark.parametrize("body", ["return nothing;", "\n#error no\n"])
def test_errors_stay_errors(tmp_path: Path, objects: Path, body: str) -> None:
    project = Project(tmp_path / "a", objects, body=body)
    assert project.build() != 0
    assert [*objects.iterdir()] == []
