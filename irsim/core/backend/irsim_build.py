"""Build backend: scikit-build-core, with a C++ compiler from PyPI on machines without one.

pip calls the functions of PEP 517 and PEP 660 in this module (``build-backend`` in ``pyproject.toml``). Each calls
scikit-build-core, which requires CMake and ninja where they are missing. Where a C++ compiler is missing, this module
requires the package ``ziglang``; scripts in a temporary folder make its clang look like an ordinary tool chain. The
variables ``CXX``, ``CMAKE_TOOLCHAIN_FILE`` and ``CMAKE_ARGS`` with a compiler or tool chain in it are respected.

The wheel of a release (``wheel.py-api=cp310``) is for all versions of Python and needs ``nanobind-backend``, which
exists only for common platforms and only with the GIL. No other build needs it, so only the metadata of that wheel
name it.
"""

from __future__ import annotations

import base64
import hashlib
import importlib.util
import os
import re
import shlex
import shutil
import stat
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from scikit_build_core import build as skbuild
from scikit_build_core.build import (
    build_sdist,
    get_requires_for_build_sdist,
    prepare_metadata_for_build_editable,
)

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
    "prepare_metadata_for_build_editable",
    "prepare_metadata_for_build_wheel",
]

ConfigSettings = Mapping[str, "str | list[str]"]

ZIGLANG = "ziglang>=0.13,<0.18"
"""The compiler package; zig has no stable release yet, so only tested minor versions are allowed."""

RUNTIME = "nanobind-backend>=1.0"
"""The package that the module of a release needs beside it."""

ZIG_TOOLS = {
    # -mcpu=baseline: zig's own default is the CPU of this machine, which would make results depend on it.
    # -s: its C++ library is compiled at the first link, and once more for a link that strips, as the module's does.
    "cc": "cc -mcpu=baseline -s",
    "c++": "c++ -mcpu=baseline -s",
    "ar": "ar",
    "ranlib": "ranlib",
}
"""Script name → what it passes to ``zig``."""

COMPILERS = ("c++", "g++", "clang++")
"""Names looked for on PATH, after the one that Python itself was built with."""


def get_requires_for_build_wheel(config_settings: ConfigSettings | None = None) -> list[str]:
    """Requirements of a wheel beyond ``build-system.requires``."""
    with _zig_generator():
        return skbuild.get_requires_for_build_wheel(_plain(config_settings)) + _compiler_requirement()


def get_requires_for_build_editable(config_settings: ConfigSettings | None = None) -> list[str]:
    """Requirements of an editable install beyond ``build-system.requires``."""
    with _zig_generator():
        return skbuild.get_requires_for_build_editable(_plain(config_settings)) + _compiler_requirement()


def build_wheel(
    wheel_directory: str, config_settings: ConfigSettings | None = None, metadata_directory: str | None = None
) -> str:
    """Build a wheel into ``wheel_directory``; returns its file name."""
    # scikit-build-core would refuse prepared metadata with a requirement that it does not know.
    with _compiler():
        name = skbuild.build_wheel(wheel_directory, _plain(config_settings))
    if "-abi3-" in name:
        require_runtime(Path(wheel_directory, name))
    return name


def prepare_metadata_for_build_wheel(metadata_directory: str, config_settings: ConfigSettings | None = None) -> str:
    """Write the metadata that the wheel will have; returns the name of their folder."""
    name = skbuild.prepare_metadata_for_build_wheel(metadata_directory, _plain(config_settings))
    folder = Path(metadata_directory, name)
    if "-abi3-" in (folder / "WHEEL").read_text(encoding="utf-8"):
        path = folder / "METADATA"
        path.write_bytes(with_runtime(path.read_bytes()))
    return name


def with_runtime(metadata: bytes) -> bytes:
    """Metadata of a package that also requires ``RUNTIME``; a second call changes nothing."""
    line = f"Requires-Dist: {RUNTIME}\n".encode()
    return metadata if line in metadata else metadata.replace(b"Requires-Dist: ", line + b"Requires-Dist: ", 1)


def require_runtime(wheel: Path) -> None:
    """Let a wheel require ``RUNTIME``."""
    change_entry(wheel, r".*\.dist-info/METADATA", with_runtime)


def with_source(finder: bytes) -> bytes:
    """The module that finds the files of an editable install, whose loaders then hand out source, as Python's do.

    Editors and notebooks that complete names with jedi skip a package if the class of its loader has no
    ``get_source``, and the class in which scikit-build-core wraps loaders lacks it.
    """
    head = b"    def __getattr__(self, name: str) -> object:\n        return getattr(self._skbuild_loader, name)\n"
    asked = head.replace(b"__getattr__", b"get_source").replace(b"_loader, name)", b"_loader, 'get_source')(name)")
    return finder if asked in finder else finder.replace(head, head + b"\n" + asked, 1)


def change_entry(wheel: Path, pattern: str, change: Callable[[bytes], bytes]) -> None:
    """Replace the file of a wheel that has such a name, if one has, and its hash; everything else stays as it is."""
    with zipfile.ZipFile(wheel) as archive:
        entries = [(entry, archive.read(entry)) for entry in archive.infolist()]
    matches = [(entry.filename, change(data)) for entry, data in entries if re.fullmatch(pattern, entry.filename)]
    if not matches:
        return
    [(name, changed)] = matches
    digest = base64.urlsafe_b64encode(hashlib.sha256(changed).digest()).rstrip(b"=").decode()
    row = f"{name},sha256={digest},{len(changed)}"
    with zipfile.ZipFile(wheel, "w") as archive:
        for entry, data in entries:
            if entry.filename == name:
                data = changed
            elif entry.filename.endswith(".dist-info/RECORD"):
                rows = data.decode().splitlines()
                data = "".join(f"{row if old.startswith(f'{name},') else old}\n" for old in rows).encode()
            archive.writestr(entry, data)


def build_editable(
    wheel_directory: str, config_settings: ConfigSettings | None = None, metadata_directory: str | None = None
) -> str:
    """Build the wheel of an editable install into ``wheel_directory``; returns its file name."""
    with _compiler():
        name = skbuild.build_editable(wheel_directory, _plain(config_settings), metadata_directory)
    change_entry(Path(wheel_directory, name), r"_editable_skbc_\w+\.py", with_source)
    return name


def chosen_by_user(environ: Mapping[str, str]) -> bool:
    """Whether the environment already sets the compiler that CMake must use."""
    named = ("CXX", "CMAKE_TOOLCHAIN_FILE")
    in_arguments = ("CMAKE_CXX_COMPILER", "CMAKE_TOOLCHAIN_FILE")
    return any(environ.get(name) for name in named) or any(
        name in environ.get("CMAKE_ARGS", "") for name in in_arguments
    )


def find_compiler() -> str | None:
    """Path of a C++ compiler of this machine, or None.

    On Windows an installed Visual Studio counts; its path is then ``""``, since CMake finds it without a path.
    """
    if os.name == "nt" and (shutil.which("cl") or _visual_studio()):
        return ""
    if sys.platform == "darwin" and not _succeeds("xcode-select", "-p"):
        return None  # /usr/bin/c++ is then a stub that offers to install Xcode
    built_with = shlex.split(sysconfig.get_config_var("CXX") or "")[:1]
    paths = (shutil.which(name) for name in (*built_with, *COMPILERS))
    return next((path for path in paths if path), None)


@contextmanager
def _compiler() -> Iterator[None]:
    """Environment in which CMake finds a C++ compiler."""
    if chosen_by_user(os.environ):
        yield
        return
    compiler = find_compiler()
    if compiler is not None:
        # Named outright: the compiler that Python was built with, CMake's first choice, need not exist here.
        with _environment({"CXX": compiler} if compiler else {}):
            yield
        return
    zig = _zig_executable()
    print(f"irsim: no C++ compiler found, building with {zig}", flush=True)
    with tempfile.TemporaryDirectory(prefix="irsim-zig-") as folder, _zig_generator():
        scripts = write_zig_scripts(Path(folder), zig)
        arguments = [f"-DCMAKE_AR={scripts['ar']}", f"-DCMAKE_RANLIB={scripts['ranlib']}"]
        given = os.environ.get("CMAKE_ARGS", "")
        with _environment(
            {
                "CC": str(scripts["cc"]),
                "CXX": str(scripts["c++"]),
                "CMAKE_ARGS": " ".join(filter(None, (given, shlex.join(arguments)))),
            }
        ):
            yield


def write_zig_scripts(folder: Path, zig: str) -> dict[str, Path]:
    """Write a script per tool into ``folder`` that runs ``zig`` under that tool's name.

    Returns:
        Tool name (``cc``, ``c++``, ``ar``, ``ranlib``) → script.
    """
    scripts = {}
    for name, arguments in ZIG_TOOLS.items():
        if os.name == "nt":
            script, text = folder / f"{name}.bat", f'@"{zig}" {arguments} %*\r\n'
        else:
            script, text = folder / name, f'#!/bin/sh\nexec {shlex.quote(zig)} {arguments} "$@"\n'
        script.write_text(text, encoding="utf-8", newline="")
        script.chmod(script.stat().st_mode | stat.S_IXUSR)
        scripts[name] = script
    return scripts


def _compiler_requirement() -> list[str]:
    """The compiler package, if this machine needs it."""
    return [] if chosen_by_user(os.environ) or find_compiler() is not None else [ZIGLANG]


def _zig_executable() -> str:
    """Path of the executable inside the ``ziglang`` package."""
    spec = importlib.util.find_spec("ziglang")
    if spec is None or spec.origin is None:
        raise SystemExit(f"irsim: no C++ compiler found. Install one, set CXX, or: pip install '{ZIGLANG}'")
    return str(Path(spec.origin).with_name("zig.exe" if os.name == "nt" else "zig"))


@contextmanager
def _zig_generator() -> Iterator[None]:
    """With zig on Windows, CMake must use ninja: its default there drives Visual Studio."""
    needed = os.name == "nt" and bool(_compiler_requirement()) and "CMAKE_GENERATOR" not in os.environ
    with _environment({"CMAKE_GENERATOR": "Ninja"} if needed else {}):
        yield


@contextmanager
def _environment(values: Mapping[str, str]) -> Iterator[None]:
    """Environment variables set for a while."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _visual_studio() -> bool:
    """Whether a Visual Studio with C++ tools is installed."""
    programs = os.environ.get("PROGRAMFILES(X86)", r"C:\Program Files (x86)")
    locator = Path(programs, "Microsoft Visual Studio", "Installer", "vswhere.exe")
    tools = "Microsoft.VisualStudio.Component.VC.Tools.x86.x64"
    if not locator.is_file():
        return False
    command = [str(locator), "-latest", "-products", "*", "-requires", tools, "-property", "installationPath"]
    return bool(subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip())


def _succeeds(*command: str) -> bool:
    """Whether a command exists and returns 0."""
    if shutil.which(command[0]) is None:
        return False
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def _plain(config_settings: ConfigSettings | None) -> dict[str, str | list[str]] | None:
    """The settings as scikit-build-core types them."""
    return None if config_settings is None else dict(config_settings)
