"""The numbers of the house: size, types that describe one thing, imports in functions, and the way of a recorded run.

``python -m tests.packaging.house`` prints them; ``test_house.py`` holds the counts of repeated ideas.
"""

from __future__ import annotations

import ast
import itertools
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

from tests.packaging.test_imports import listed_rooms

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("irsim", "mcp_server", "evals")
_POSE = {"at", "pose", "poses", "position", "record", "state", "view"}
_SHAPE = {"corners", "footprint", "geometry", "outline", "parts", "radius", "shape", "vertices"}
_PARTS_LOOP = r"enumerate\([\w.]*(?:state)?\.?(?:parts\(|kinds\))|kinds = [\w.]*state\.parts"
_PROBE = Path(__file__).with_name("house_probe.py")


@cache
def sources() -> dict[Path, str]:
    """File, relative to the checkout -> its text, for all Python of the three packages."""
    texts = {}
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            texts[path.relative_to(ROOT)] = path.read_text(encoding="utf-8")
    return texts


@cache
def trees() -> dict[Path, ast.Module]:
    """File -> its syntax tree; templates of programs in the evals, which do not parse, are left out."""
    parsed = {}
    for path, text in sources().items():
        try:
            parsed[path] = ast.parse(text)
        except SyntaxError:
            continue
    return parsed


def object_types() -> list[str]:
    """Classes that describe an object: they have a pose, or the record that has it, and a shape among their fields."""
    return [
        f"{path}:{node.name}"
        for path, tree in trees().items()
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef) and (names := _fields(node)) & _POSE and names & _SHAPE
    ]


def problem_types() -> list[str]:
    """Classes that describe a problem: they have a code and a fix among their fields."""
    return [
        f"{path}:{node.name}"
        for path, tree in trees().items()
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef) and _fields(node) >= {"code", "fix"}
    ]


def _fields(node: ast.ClassDef) -> set[str]:
    """Names of annotated fields, of properties, and of what ``__init__`` assigns, without leading underscores."""
    names = set()
    for item in node.body:
        if isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name):
            names.add(item.target.id)
        elif isinstance(item, ast.FunctionDef):
            if any(ast.unparse(word).endswith("property") for word in item.decorator_list):
                names.add(item.name)
            elif item.name == "__init__":
                names |= {name.attr for name in ast.walk(item) if _is_own(name)}
    return {name.strip("_") for name in names}


def _is_own(node: ast.AST) -> bool:
    return (
        isinstance(node, ast.Attribute)
        and isinstance(node.ctx, ast.Store)
        and isinstance(node.value, ast.Name)
        and node.value.id == "self"
    )


def files_with(pattern: str) -> list[str]:
    """Files whose text has a match of a pattern."""
    return [str(path) for path, text in sources().items() if re.search(pattern, text)]


def translators() -> list[str]:
    """Files that read the list of errors of pydantic, or lines of its text below the first."""
    return files_with(r"\[[\"']loc[\"']\]|\.errors\((include_\w+=\w+)?\)|\)\.splitlines\(\)\[1\]")


def function_imports(package: str = "irsim") -> int:
    """Number of lines with an import inside a function."""
    return sum(len(_import_lines(tree)) for path, tree in trees().items() if path.parts[0] == package)


def _import_lines(tree: ast.Module) -> set[int]:
    functions = (node for node in ast.walk(tree) if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)))
    inner = (item for node in functions for item in ast.walk(node))
    return {item.lineno for item in inner if isinstance(item, (ast.Import, ast.ImportFrom))}


def part_loops() -> list[str]:
    """Files with a loop over the kinds of the parts of a body."""
    return files_with(_PARTS_LOOP)


def process_starts() -> list[str]:
    """Files that start a process; building the core is another program's work."""
    starts = files_with(
        r"subprocess\.(Popen|run|call|check_\w+)\(|anyio\.open_process\(|\.Process\(|get_context\([\"']"
    )
    return [file for file in starts if not file.startswith("irsim/core/backend")]


def child_protocols() -> list[str]:
    """Files that start a process of this project and talk with it: by pipes, without waiting, or by a fork server."""
    talking = r"(?s)sys\.executable.*stdin=subprocess\.PIPE|anyio\.open_process\(|get_context\([\"']"
    return [file for file in process_starts() if re.search(talking, sources()[Path(file)])]


def hashes() -> list[str]:
    """Files that compute a hash; the backend that builds the package cannot import it."""
    return [file for file in files_with(r"\bhashlib\b") if not file.startswith("irsim/core/backend")]


def limited_reads() -> list[str]:
    """Files that read one byte more than a limit, to learn whether a file is larger."""
    return files_with(r"read\([^()]* \+ 1\)")


def schema_versions() -> list[str]:
    """Files that name the version of JSON Schema."""
    return files_with(r"json-schema\.org/draft")


def process_limits() -> list[str]:
    """Files that limit what a process uses."""
    return files_with(r"\.setrlimit\(")


@cache
def run_of_one() -> dict[str, int]:
    """The second recorded run of one robot: calls, files, changes of room and box; public names of a robot, an Env."""
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    done = subprocess.run(
        [sys.executable, str(_PROBE)], capture_output=True, text=True, check=True, cwd=ROOT.parent, env=environment
    )
    told = json.loads(done.stdout.splitlines()[-1])
    rooms = [name for name in told.pop("rooms") if name in listed_rooms()]
    boxes = [listed_rooms()[name] for name in rooms]
    changes = {"changes of room": _changes(rooms), "changes of box": _changes(boxes)}
    return {**told, **changes}


def _changes(names: list[str]) -> int:
    return sum(1 for _ in itertools.groupby(names))


def docstring_lines() -> int:
    """Lines of docstrings in the three packages."""
    return sum(_doc(node) for tree in trees().values() for node in ast.walk(tree))


def _doc(node: ast.AST) -> int:
    if not isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
        return 0
    return len((ast.get_docstring(node, clean=False) or "").splitlines())


def rows() -> Iterator[tuple[str, object]]:
    """All numbers, each with its name."""
    tests = [path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*.py")]
    sizes = [len(text.splitlines()) for text in sources().values()]
    yield "Python lines of irsim, mcp_server and evals", sum(sizes)
    yield "  of them docstrings", docstring_lines()
    yield "files", len(sizes)
    yield "files of less than 100 lines", sum(size < 100 for size in sizes)
    yield "lines of tests", sum(len(text.splitlines()) for text in tests)
    yield "files of tests", len(tests)
    counted: dict[str, Callable[[], list[str]]] = {
        "types that describe an object": object_types,
        "loops over the kinds of parts": part_loops,
        "files that limit a process": process_limits,
        "files that translate errors of models": translators,
        "types that describe a problem": problem_types,
        "files that start a process": process_starts,
        "files that talk with a process of this project": child_protocols,
        "files that hash": hashes,
        "files that read within a limit": limited_reads,
        "files that name the version of JSON Schema": schema_versions,
    }
    for name, find in counted.items():
        yield name, len(find())
        yield from ((f"  {place}", "") for place in find())
    for package in PACKAGES:
        yield f"imports inside functions, {package}", function_imports(package)
    yield from ((f"a recorded run: {name}", number) for name, number in run_of_one().items())


if __name__ == "__main__":
    for name, number in rows():
        print(f"{name:90} {number}")
