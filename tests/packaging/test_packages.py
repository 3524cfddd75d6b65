"""Source distribution, wheel and editable install: what is in them, and that each works away from the checkout."""

from __future__ import annotations

import json
import os
import shutil
import tarfile
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from irsim.compat.paths import stub_files

# One process has them all, and so builds sdist and wheel once; the other one builds without a compiler meanwhile.
pytestmark = [pytest.mark.slow(60), pytest.mark.xdist_group("packages")]

ROOT = Path(__file__).resolve().parents[2]
COMPILERS = ("c++", "g++", "gcc", "cc", "clang", "clang++", "cmake", "ninja", "make", "ar")


def files_of(folder: str) -> set[str]:
    """Files of a folder of the checkout, relative to the root."""
    paths = (ROOT / folder).rglob("*")
    return {path.relative_to(ROOT).as_posix() for path in paths if path.is_file() and path.suffix != ".pyc"}


@pytest.fixture(scope="session")
def sdist_names(sdist: Path) -> set[str]:
    with tarfile.open(sdist) as archive:
        return {name.partition("/")[2] for name in archive.getnames()}


@pytest.fixture(scope="session")
def wheel_names(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as archive:
        return set(archive.namelist())


def test_sdist_holds_what_a_build_needs(sdist_names: set[str]) -> None:
    folders = ("irsim", "mcp_server", "templates", "schema", "evals/irsim_evals", "evals/cases", "evals/golds")
    needed = {name for folder in folders for name in files_of(folder)}
    assert sorted(needed - sdist_names) == []
    assert {"pyproject.toml", "README.md", "LICENSE", "CHANGELOG.md"} <= sdist_names


def test_sdist_holds_nothing_else(sdist_names: set[str]) -> None:
    folders = {name.partition("/")[0] for name in sdist_names if "/" in name}
    assert folders <= {"irsim", "mcp_server", "templates", "schema", "skills", "evals"}
    assert not any(name.endswith((".so", ".pyd", ".pyc")) for name in sdist_names)


def test_wheel_holds_the_packages_and_stubs_only(wheel_names: set[str]) -> None:
    folders = {name.partition("/")[0] for name in wheel_names}
    ours = {"irsim", "irsim_mcp", "irsim_evals", "irsim-stubs"}
    assert {folder for folder in folders if not folder.endswith(".dist-info")} == ours
    assert sum(name.startswith("irsim/_core.") and name.endswith((".so", ".pyd")) for name in wheel_names) == 1


def test_one_wheel_is_for_all_versions_of_python(wheel: Path, wheel_names: set[str]) -> None:
    assert "-cp310-abi3-" in wheel.name
    [module] = [name for name in wheel_names if name.startswith("irsim/_core.") and name.endswith((".so", ".pyd"))]
    assert module in ("irsim/_core.abi3.so", "irsim/_core.pyd")
    assert wheel.stat().st_size <= 8_000_000
    with zipfile.ZipFile(wheel) as archive:
        code = archive.read(module)
    assert str(wheel.parent.parent).encode() not in code
    assert b"/irsim/core/" not in code  # no folder of the machine that built it


def test_only_the_wheel_needs_a_part_of_its_module_from_another_package(wheel: Path, sdist: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        [name] = [name for name in archive.namelist() if name.endswith(".dist-info/METADATA")]
        assert "Requires-Dist: nanobind-backend>=1.0" in archive.read(name).decode().splitlines()
    with tarfile.open(sdist) as archive:
        [name] = [name for name in archive.getnames() if name.count("/") == 1 and name.endswith("/PKG-INFO")]
        information = archive.extractfile(name)
        assert information is not None
        assert b"nanobind-backend" not in information.read()


def test_wheel_holds_data_and_types(wheel_names: set[str]) -> None:
    data = {f"irsim/_bundled/{name}" for name in files_of("templates") | files_of("schema")}
    skills = {f"irsim/.agents/{name}" for name in files_of("skills")}
    skills |= {
        name.replace("evals/", "irsim_evals/data/", 1) for k in ("cases", "golds") for name in files_of(f"evals/{k}")
    }
    assert sorted((data | skills | files_of("irsim/runs/replay")) - wheel_names) == []
    assert {"irsim/py.typed", "irsim/_core.pyi", "irsim_mcp/py.typed"} <= wheel_names
    assert sorted({f"irsim-stubs/{name}" for name in stub_files()} - wheel_names) == []


def test_wheel_holds_no_sources_of_the_core(wheel_names: set[str]) -> None:
    code = {name for name in wheel_names if not name.startswith("irsim/.agents/")}  # where skills show examples
    assert [name for name in code if name.startswith("irsim/core/") or name.endswith((".cpp", ".hpp"))] == []


def test_license_and_python_versions_are_declared(wheel: Path, wheel_names: set[str]) -> None:
    [name] = [name for name in wheel_names if name.endswith(".dist-info/METADATA")]
    with zipfile.ZipFile(wheel) as archive:
        metadata = archive.read(name).decode()
    assert "License-Expression: MIT" in metadata
    assert "Requires-Python: >=3.10" in metadata
    assert any(name.endswith(".dist-info/licenses/LICENSE") for name in wheel_names)


def install_wheel(environment: Any, request: pytest.FixtureRequest) -> None:
    environment.pip("install", "-q", request.getfixturevalue("wheel"))


def install_editable(environment: Any, request: pytest.FixtureRequest) -> None:
    """With the dependencies of this environment: that all are found is asked of the wheel."""
    copy = unpacked(request.getfixturevalue("sdist"), environment.folder / "checkout")
    environment.share_libraries()
    environment.pip("install", "-q", "-e", copy)


def install_without_compiler(environment: Any, request: pytest.FixtureRequest) -> None:
    """A source distribution, where there is Python and nothing else: not one program of the system is on PATH.

    Nothing is optimized, which halves the time and makes no difference to what is found and built.
    """
    environment.share_libraries()
    nothing = environment.folder / "nothing"
    nothing.mkdir()
    path = f"{environment.bin}{os.pathsep}{nothing}"
    variables = {"PATH": path, "CXX": "", "CC": "", "CMAKE_CXX_COMPILER_LAUNCHER": ""}
    variables |= {"SKBUILD_CMAKE_BUILD_TYPE": "Plain", "CXXFLAGS": "-O0 -fno-sanitize=undefined"}
    assert not any(shutil.which(name, path=variables["PATH"]) for name in COMPILERS)
    log = environment.folder / "pip.log"
    environment.pip("install", "--log", log, request.getfixturevalue("sdist"), **variables)
    assert "no C++ compiler found, building with" in log.read_text(encoding="utf-8")


CLIENT = """
import sys

import anyio
from mcp import Client, StdioServerParameters


async def main():
    async with Client(StdioServerParameters(command=sys.argv[1])) as client:
        print((await client.list_tools()).tools[0].name)
        result = await client.call_tool("validate_scenario", {"scenario_path": "scene.yaml"})
        print(result.structured_content["valid"])


anyio.run(main)
"""
"""Asks the server of another environment, in the current directory, about ``scene.yaml``."""


def unpacked(sdist: Path, folder: Path) -> Path:
    """The single folder inside a source distribution."""
    with tarfile.open(sdist) as archive:
        archive.extractall(folder, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
    [inner] = folder.iterdir()
    return inner


without_compiler = pytest.param(
    install_without_compiler,
    marks=[
        pytest.mark.skipif(os.name == "nt", reason="an empty PATH does not hide Visual Studio"),
        pytest.mark.slow(200),
        pytest.mark.rotates(3),
        pytest.mark.xdist_group("without compiler"),
    ],
)


@pytest.fixture(
    scope="session",
    params=[install_wheel, install_editable, without_compiler],
    ids=lambda install: getattr(install, "__name__", None),
)
def installed(request: pytest.FixtureRequest, new_environment: Callable[[str], Any]) -> Iterator[Any]:
    """An environment that was empty before irsim was installed into it."""
    environment = new_environment(request.param.__name__)
    request.param(environment, request)
    yield environment
    shutil.rmtree(environment.folder)


def test_installed_package_works_from_elsewhere(installed: Any, tmp_path: Path) -> None:
    names = [row["name"] for row in json.loads(installed.run("irsim", "templates", "--json", cwd=tmp_path))]
    assert set(names) == {path.parent.name for path in ROOT.glob("templates/*/scenario.yaml")}
    installed.run("irsim", "new", names[0], "-o", "scene.yaml", cwd=tmp_path)
    installed.run("irsim", "validate", "scene.yaml", cwd=tmp_path)
    installed.run("irsim", "schema", "-o", "schema.json", cwd=tmp_path)
    assert json.loads((tmp_path / "schema.json").read_text(encoding="utf-8"))["$schema"]
    installed.run("irsim", "demo", cwd=tmp_path)
    assert [path.read_bytes()[:4] for path in tmp_path.rglob("*.gif")] == [b"GIF8"]
    assert installed.run("irsim-mcp", "--version", cwd=tmp_path).startswith("irsim-mcp ")
    script = installed.bin / "irsim-mcp"
    assert installed.run("python", "-c", CLIENT, script, cwd=tmp_path).split() == ["lookup", "True"]


def test_ir_sim_installed_on_top_is_refused(wheel: Path, new_environment: Callable[[str], Any], tmp_path: Path) -> None:
    """pip overwrites ``irsim/__init__.py`` without a word, so the server and the command line have to notice."""
    environment = new_environment("both")
    environment.pip("install", "-q", "--no-deps", wheel)
    stranger = tmp_path / "ir_sim-2.12.0-py3-none-any.whl"
    with zipfile.ZipFile(stranger, "w") as archive:
        archive.writestr("irsim/__init__.py", "")
        archive.writestr("ir_sim-2.12.0.dist-info/METADATA", "Metadata-Version: 2.1\nName: ir-sim\nVersion: 2.12.0\n")
        archive.writestr(
            "ir_sim-2.12.0.dist-info/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
        )
        archive.writestr("ir_sim-2.12.0.dist-info/RECORD", "")
    environment.pip("install", "-q", "--no-deps", "--no-index", stranger)
    for code in ("import irsim_mcp", "from irsim.cli import main; main()"):
        refusal = environment.run(
            "python", "-c", f"try:\n    {code}\nexcept (ImportError, SystemExit) as e:\n    print(e)"
        )
        assert "pip uninstall -y ir-sim irsim-mcp" in refusal
