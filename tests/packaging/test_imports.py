"""What an import loads, and which way imports point."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

LAYERS = (
    """
    _conflict _names _options angles code_examples codes colors diagnostics errors files log registry resources
    selection units vectors version
    """,
    "_core arguments compatibility msg streams text",
    "kinematics shapes behaviors sensors distributions maps planners",
    "scenario",
    "world simulation",
    """
    actions
    batch
    body
    contacts
    crowd
    current
    env
    env_access
    env_custom
    env_drawing
    env_live
    env_maps
    env_messages
    env_objects
    exchange
    gui
    hooks
    info
    map_view
    matter
    metrics
    navigation
    object_avoidance
    object_base
    object_drawing
    object_factory
    object_list
    object_status
    observers
    parameters
    python_behaviors
    python_drives
    python_parts
    render
    scans
    sensing
    sensor_factory
    settings
    views
    """,
    """
    api
    benchmarks
    bridges
    changes
    comparison
    config
    contents
    description
    dry_run
    episode
    learning
    leaving
    lib
    labels
    lookup
    map_files
    modeline
    overlays
    replay
    results
    runs
    skills
    snapshot
    standing
    strips
    survey
    templates
    testing
    util
    validation
    verdict
    workload
    """,
    "cli __main__",
    "irsim_mcp",
)
"""Modules and packages of ``irsim``, lowest layer first: one imports its own layer and those before it."""

EXCEPTIONS = {
    ("errors", "scenario"),  # a ScenarioError prints itself with the report of that package, loaded at that moment
    ("views", "lib"),  # robot.kf is a handler of that package, made when somebody asks
    ("render", "api"),  # irsim.render is a function too: calling the package calls the one of irsim.api
}
"""Imports inside functions that may point down the list."""

RANK = {name: rank for rank, layer in enumerate(LAYERS) for name in layer.split()}


def sources() -> Iterator[tuple[str, Path]]:
    """Every Python file of the two packages, with the name its layer has."""
    for path in sorted(ROOT.glob("irsim/**/*.py*")):
        part = path.relative_to(ROOT / "irsim").parts[0].partition(".")[0]
        if path.suffix in (".py", ".pyi") and part not in ("__init__", "core"):
            yield part, path
    for path in sorted(ROOT.glob("mcp_server/irsim_mcp/**/*.py")):
        yield "irsim_mcp", path


def imported(path: Path) -> Iterator[tuple[str, bool]]:
    """Parts of irsim that a file imports when it runs, and whether only inside a function."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for_types = {
        id(node)
        for block in ast.walk(tree)
        if isinstance(block, ast.If) and "TYPE_CHECKING" in ast.unparse(block.test)
        for statement in block.body
        for node in ast.walk(statement)
    }
    functions = [node for node in ast.walk(tree) if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]
    inside = {id(node) for function in functions for node in ast.walk(function)}
    for node in ast.walk(tree):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: a relative import"
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        for name in names:
            package, _, rest = name.partition(".")
            part = rest.partition(".")[0] if package == "irsim" else package
            if part in RANK and package in ("irsim", "irsim_mcp") and id(node) not in for_types:
                yield part, id(node) in inside


def test_every_module_has_a_layer() -> None:
    assert sorted({part for part, _ in sources()} - set(RANK)) == []


def test_imports_point_to_lower_layers() -> None:
    wrong = [
        f"{path.relative_to(ROOT)} imports irsim.{other}"
        for part, path in sources()
        for other, lazily in imported(path)
        if RANK.get(other, 0) > RANK.get(part, 0) and not (lazily and (part, other) in EXCEPTIONS)
    ]
    assert wrong == []


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
from irsim.batch import Batch
import irsim, pathlib, tempfile
with tempfile.TemporaryDirectory() as folder:
    path = pathlib.Path(folder, "room.yaml")
    path.write_text("robot: {kinematics: {name: diff}, goal: [4, 4]}\\n")
    assert isinstance(irsim.batch(path, 2), Batch)"""
    )
