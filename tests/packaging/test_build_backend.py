"""The build backend: which compiler it finds, and what it asks for without one."""

from __future__ import annotations

import base64
import hashlib
import importlib.machinery
import importlib.util
import os
import subprocess
import sys
import zipfile
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def backend() -> ModuleType:
    """``irsim_build``, which is not part of the installed package."""
    spec = importlib.util.spec_from_file_location("irsim_build", ROOT / "irsim/core/backend/irsim_build.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def bare(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A machine without compilers: a PATH with one empty folder in it, which is returned."""
    for name in ("CC", "CXX", "CMAKE_ARGS", "CMAKE_TOOLCHAIN_FILE", "CMAKE_GENERATOR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("PROGRAMFILES(X86)", str(tmp_path))
    monkeypatch.chdir(ROOT)
    return tmp_path


def tool(folder: Path, name: str) -> Path:
    """An executable that does nothing."""
    path = folder / (f"{name}.exe" if os.name == "nt" else name)
    path.write_text("#!/bin/sh\n", encoding="utf-8")
    path.chmod(0o755)
    return path


@pytest.mark.parametrize("hook", ["get_requires_for_build_wheel", "get_requires_for_build_editable"])
def test_asks_for_everything_on_a_bare_machine(backend: ModuleType, bare: Path, hook: str) -> None:
    names = {requirement.partition(">")[0] for requirement in getattr(backend, hook)()}
    assert names == {"cmake", "ninja", "ziglang"}


@pytest.mark.parametrize(
    ("variable", "value"),
    [
        ("CXX", "my-c++"),
        ("CMAKE_TOOLCHAIN_FILE", "arm.cmake"),
        ("CMAKE_ARGS", "-DCMAKE_CXX_COMPILER=my-c++"),
    ],
)
def test_a_compiler_that_the_user_names_is_respected(
    backend: ModuleType, bare: Path, monkeypatch: pytest.MonkeyPatch, variable: str, value: str
) -> None:
    monkeypatch.setenv(variable, value)
    assert not any("ziglang" in requirement for requirement in backend.get_requires_for_build_wheel())


@pytest.mark.parametrize("name", ["c++", "g++", "clang++"])
def test_any_usual_compiler_on_path_will_do(
    backend: ModuleType, bare: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.setattr(backend, "_succeeds", lambda *command: True)  # Xcode, on macOS
    compiler = tool(bare, name)
    assert backend.find_compiler() == str(compiler)
    assert not any("ziglang" in requirement for requirement in backend.get_requires_for_build_wheel())


def test_source_distributions_need_no_compiler(backend: ModuleType, bare: Path) -> None:
    assert backend.get_requires_for_build_sdist() == []


@pytest.mark.skipif(os.name == "nt", reason="the stand-in for zig is a shell script")
def test_scripts_pass_their_arguments_on(backend: ModuleType, tmp_path: Path) -> None:
    zig = tmp_path / "a folder" / "zig"
    zig.parent.mkdir()
    zig.write_text('#!/bin/sh\nprintf "%s\\n" "$@"\n', encoding="utf-8")
    zig.chmod(0o755)
    scripts = backend.write_zig_scripts(tmp_path, str(zig))
    done = subprocess.run([scripts["c++"], "-O2", "two words.cpp"], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["c++", "-mcpu=baseline", "-s", "-O2", "two words.cpp"]


def test_a_missing_compiler_package_is_named(backend: ModuleType, bare: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ziglang", None)
    with pytest.raises(SystemExit, match="ziglang"):
        backend.build_wheel(str(bare))


def test_loaders_of_an_editable_install_hand_out_source(backend: ModuleType) -> None:
    call = "    def __getattr__(self, name: str) -> object:\n        return getattr(self._skbuild_loader, name)\n"
    begin = "    def __init__(self, loader: object) -> None:\n        self._skbuild_loader = loader\n\n"
    finder = f"class Wrapper:\n{begin}{call}".encode()
    changed = backend.with_source(finder)
    assert backend.with_source(changed) == changed
    made: dict[str, Any] = {}
    exec(changed, made)
    loader = importlib.machinery.SourceFileLoader("here", __file__)
    assert "get_source" in vars(made["Wrapper"])
    assert made["Wrapper"](loader).get_source("here") == Path(__file__).read_text(encoding="utf-8")
    assert made["Wrapper"](loader).path == __file__
    assert backend.with_source(b"x = 1\n") == b"x = 1\n"


METADATA = b"Metadata-Version: 2.4\nName: x\nVersion: 1\nRequires-Dist: numpy>=1.26\nRequires-Dist: rich\n\nText\n"


def test_the_wheel_of_a_release_requires_the_runtime_of_its_module(backend: ModuleType, tmp_path: Path) -> None:
    wheel, info = tmp_path / "x-1-cp310-abi3-any.whl", "x-1.dist-info"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in ((f"{info}/METADATA", METADATA), ("x.py", b"y = 1\n")):
            archive.writestr(zipfile.ZipInfo(name, (2026, 1, 2, 3, 4, 6)), text)
        archive.writestr(f"{info}/RECORD", f"{info}/METADATA,sha256=old,1\nx.py,sha256=abc,6\n{info}/RECORD,,\n")
    backend.require_runtime(wheel)
    once = wheel.read_bytes()
    backend.require_runtime(wheel)
    assert wheel.read_bytes() == once
    with zipfile.ZipFile(wheel) as archive:
        metadata = archive.read(f"{info}/METADATA")
        rows = archive.read(f"{info}/RECORD").decode().splitlines()
        assert archive.read("x.py") == b"y = 1\n"
        assert archive.getinfo("x.py").date_time == (2026, 1, 2, 3, 4, 6)
    assert metadata == METADATA.replace(
        b"Requires-Dist: numpy", b"Requires-Dist: nanobind-backend>=1.0\nRequires-Dist: numpy"
    )
    digest = base64.urlsafe_b64encode(hashlib.sha256(metadata).digest()).decode().rstrip("=")
    assert rows == [f"{info}/METADATA,sha256={digest},{len(metadata)}", "x.py,sha256=abc,6", f"{info}/RECORD,,"]
