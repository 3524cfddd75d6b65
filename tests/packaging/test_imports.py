"""Which way imports point, how large files are, and what an import loads."""

from __future__ import annotations

import ast
import itertools
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

import pytest

from irsim.compat.paths import NAMES, SAME

ROOT = Path(__file__).resolve().parents[2]
MAX_BOXES = 14
MAX_ARROWS = 64
MAX_LINES = 400
LOOSE = {"__init__.py", "__main__.py", "_core.pyi", "plugins.py", "py.typed"}
"""Files that may stand directly below ``irsim/``."""
BESIDE_ROOMS = {"docs", "evals", "fuzz", "interop", "mcp", "packaging", "parity", "skills", "speed", "site"}
"""Folders of tests that are about more than one room, or about what stands beside the rooms."""
HELPERS = {"peers", "warm"}
"""Folders of ``tests/`` without any test."""
MAY_IMPORT_COMPAT = {"irsim", "compat", "env", "lookup", "cli", "irsim_mcp"}


@cache
def listed_rooms() -> dict[str, str]:
    """Rooms in the order of CONTRIBUTING.md -> box."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").partition("## Rooms")[2].partition("\n## ")[0]
    return dict(re.findall(r"^\| `(\w+)` \| (\w+) \| .* \|$", text, re.MULTILINE))


@cache
def sources() -> dict[str, Path]:
    """Module -> file, for all Python of the two packages."""
    files = {}
    for package, folder in (("irsim", ROOT / "irsim"), ("irsim_mcp", ROOT / "mcp_server" / "irsim_mcp")):
        for path in folder.rglob("*.py"):
            parts = path.relative_to(folder).with_suffix("").parts
            if parts[:2] != ("core", "backend"):
                files[".".join([package, *parts]).removesuffix(".__init__")] = path
    return files


@cache
def imports(module: str) -> tuple[tuple[str, int], ...]:
    """Modules of the two packages that a file names, lazily or for types too, each with its line."""
    known = sources()
    return tuple(
        (target, line)
        for name, line in imported_names(sources()[module])
        if (target := name if name in known else name.rpartition(".")[0]) in known
        and target != module
        and not name.startswith("irsim._core")
    )


def imported_names(path: Path) -> Iterator[tuple[str, int]]:
    """Every imported module, and every name with the module it is imported from."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((alias.name, node.lineno) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: a relative import"
            yield from ((f"{node.module}.{alias.name}", node.lineno) for alias in node.names)
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module"):
            yield from (
                (argument.value, node.lineno)
                for argument in node.args[:1]
                if isinstance(argument, ast.Constant) and isinstance(argument.value, str)
            )


def room(module: str) -> str:
    """The room of a module; ``irsim`` and ``irsim_mcp`` are rooms of their own."""
    parts = module.split(".")
    return parts[1] if parts[0] == "irsim" and len(parts) > 1 else parts[0]


def circles(graph: Mapping[str, list[str]]) -> list[list[str]]:
    """Groups of modules that import one another (Tarjan's strongly connected components, of more than one)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    groups: list[list[str]] = []

    def visit(node: str) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in graph[node]:
            if other not in index:
                visit(other)
            if other in stack:
                low[node] = min(low[node], low[other])
        if low[node] == index[node]:
            group = stack[stack.index(node) :]
            del stack[stack.index(node) :]
            if len(group) > 1:
                groups.append(sorted(group))

    for node in graph:
        if node not in index:
            visit(node)
    return groups


def test_the_rooms_are_those_of_the_guide() -> None:
    there = {path.name for path in (ROOT / "irsim").iterdir() if path.is_dir() and any(path.rglob("*.py"))}
    there |= {"plugins"}
    assert there == set(listed_rooms())
    loose = {path.name for path in (ROOT / "irsim").iterdir() if path.is_file() and path.suffix not in (".so", ".pyd")}
    assert loose == LOOSE


def test_tests_mirror_the_rooms() -> None:
    """Each room has a folder of tests; other folders are named in the sets above."""
    folders = {path.name: {*path.rglob("test_*.py")} for path in (ROOT / "tests").iterdir() if any(path.rglob("*.py"))}
    rooms = {name for name in listed_rooms() if (ROOT / "irsim" / name).is_dir()}
    assert {name for name, tests in folders.items() if tests} == rooms | BESIDE_ROOMS
    assert {name for name, tests in folders.items() if not tests} == HELPERS


def test_a_room_imports_only_rooms_above_it() -> None:
    rank = {name: number for number, name in enumerate([*listed_rooms(), "__main__", "irsim", "irsim_mcp"])}
    wrong = [
        f"{sources()[module].relative_to(ROOT)}:{line} imports {target}"
        for module in sources()
        for target, line in imports(module)
        if module != "irsim" and rank[room(target)] > rank[room(module)]
    ]
    assert wrong == []


def test_few_arrows_lead_from_box_to_box() -> None:
    """A box is a group of rooms that stand beside each other, so an arrow to a room above leads to a box above."""
    boxes = listed_rooms() | dict.fromkeys(("__main__", "irsim_mcp"), "faces")
    assert len(list(itertools.groupby(boxes.values()))) == len(set(boxes.values())) <= MAX_BOXES
    arrows = {
        (boxes[room(module)], boxes[room(target)])
        for module in sources()
        for target, _ in imports(module)
        if "irsim" not in (module, target)
    }
    assert len([arrow for arrow in arrows if arrow[0] != arrow[1]]) <= MAX_ARROWS


def test_no_files_import_one_another_in_a_circle() -> None:
    graph = {module: [target for target, _ in imports(module)] for module in sources()}
    assert circles(graph) == []
    assert circles({"a": ["b"], "b": ["c"], "c": ["b"]}) == [["b", "c"]]


def test_few_rooms_know_the_old_names() -> None:
    using = {room(module) for module in sources() for target, _ in imports(module) if room(target) == "compat"}
    assert using <= MAY_IMPORT_COMPAT


def test_what_only_scripts_of_2_12_use_is_in_its_rooms() -> None:
    """A module elsewhere that an old path leads to is used by today's code, not only by scripts."""
    old = ("irsim.compat.", "irsim.env.old.")
    homes = {home.partition(":")[0] for names in NAMES.values() for home in names.values()} | {*SAME.values()}
    shared = {home for home in homes if home.startswith("irsim.") and not home.startswith(old)}
    users = (module for module, path in sources().items() if path.name != "__init__.py" and not module.startswith(old))
    assert shared - {target for module in users for target, _ in imports(module)} == set()


def test_files_are_short() -> None:
    kinds = ("*.py", "*.cpp", "*.hpp", "*.js")
    files = [path for folder in ("irsim", "mcp_server", "skills", "evals", "tests") for kind in kinds
             for path in (ROOT / folder).rglob(kind)]  # fmt: skip
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in files}
    assert [f"{path.relative_to(ROOT)}: {n}" for path, n in lengths.items() if n > MAX_LINES] == []


def loaded_by(statement: str) -> set[str]:
    """Top-level modules in memory after a statement, in a process of its own."""
    code = f"{statement}\nimport sys\nprint(*sorted({{name.partition('.')[0] for name in sys.modules}}))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


@pytest.mark.parametrize("heavy", ["matplotlib", "shapely", "mcp", "typer", "rich", "PIL", "jsonschema"])
def test_import_irsim_loads_nothing_heavy(heavy: str) -> None:
    assert heavy not in loaded_by("import irsim")


def test_import_of_the_server_package_loads_neither_sdk_nor_engine() -> None:
    assert loaded_by("import irsim_mcp") & {"mcp", "numpy", "matplotlib"} == set()


def test_running_a_scenario_headless_draws_nothing() -> None:
    yaml = "world: {width: 5, height: 5}\\nrobot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [4, 4, 0]}\\n"
    loaded = loaded_by(
        f"""
import irsim, pathlib, tempfile
with tempfile.TemporaryDirectory() as folder:
    path = pathlib.Path(folder, "room.yaml")
    path.write_text("{yaml}")
    env = irsim.make(str(path), headless=True)
    env.step()
    env.end()"""
    )
    assert loaded & {"matplotlib", "mcp", "typer"} == set()


def test_the_package_says_it_is_typed() -> None:
    for package in ("irsim", "mcp_server/irsim_mcp"):
        assert (ROOT / package / "py.typed").is_file()


def test_a_function_works_though_its_module_of_the_same_name_was_imported_first() -> None:
    assert "numpy" in loaded_by(
        """
from irsim.env.batch import Batch
import irsim, pathlib, tempfile
with tempfile.TemporaryDirectory() as folder:
    path = pathlib.Path(folder, "room.yaml")
    path.write_text("robot: {kinematics: {name: diff}, goal: [4, 4]}\\n")
    assert isinstance(irsim.batch(path, 2), Batch)"""
    )


def test_tests_import_only_helpers_that_are_there() -> None:
    """A change that moves or renames a helper of tests looks for those who import it."""
    missing = [
        f"{path.relative_to(ROOT)}: {name}"
        for path in (ROOT / "tests").rglob("*.py")
        for name in imported_names(path)
        if name[0].startswith("tests.") and not _is_there(name[0])
    ]
    assert missing == []


@cache
def _is_there(name: str) -> bool:
    """Whether a name below ``tests`` is a module, a folder, or a name that a module binds."""
    place = ROOT / name.replace(".", "/")
    if place.is_dir() or place.with_suffix(".py").is_file():
        return True
    module = next(
        (path for path in (place.parent.with_suffix(".py"), place.parent / "__init__.py") if path.exists()), None
    )
    return module is not None and place.name in _bound(module)


@cache
def _bound(module: Path) -> set[str]:
    """All names that statements of a module bind, those in blocks too."""
    names = set()
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            names.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            names |= {(alias.asname or alias.name).partition(".")[0] for alias in node.names}
    return names
