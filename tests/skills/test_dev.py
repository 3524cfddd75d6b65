"""The skill ``irsim-dev``: what it names exists, and its examples work in a copy of the tree or as a plug-in."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
import yaml

import irsim._core as core
from irsim.diagnostics import codes
from irsim.options.registry import REGISTRIES
from tests.packaging.conftest import Environment
from tests.skills.conftest import ROOT, commands, execute, fences, parts, read, script, spans
from tests.warm import warm

SKILL = ROOT / "skills" / "irsim-dev"
EXAMPLES = SKILL / "examples"
_, BODY = parts(SKILL / "SKILL.md")
Run = Callable[..., str]


def copy_tree(folder: Path) -> None:
    """Copy a checkout without its history."""
    for name in ("irsim", "mcp_server", "schema", "skills", "templates", "tests"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__", "*.so", "*.pyd"))
    for name in ("pyproject.toml", "README.md", "LICENSE", "CHANGELOG.md"):
        shutil.copy(ROOT / name, folder / name)


def put_into(folder: Path, example: str) -> None:
    for name in ("irsim", "tests"):
        shutil.copytree(EXAMPLES / example / name, folder / name, dirs_exist_ok=True)


@pytest.fixture
def checkout(tmp_path: Path) -> tuple[Path, Run]:
    """A copy of the tree with the compiled core of this one, and what runs a command in it."""
    copy_tree(tmp_path)
    shutil.copy(core.__file__, tmp_path / "irsim")
    paths = [str(tmp_path), str(tmp_path / "mcp_server"), *(path for path in sys.path if "site-packages" in path)]
    paths += [path for path in sys.path if path and Path(path).is_dir() and str(ROOT) not in path]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(dict.fromkeys(paths))}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)  # a dozen processes would compile the copy again

    def run(words: Sequence[str], code: int = 0) -> str:
        # Without site: the hook of an editable install would lead back to this tree.
        words = words[2:] if words[0] == "python" else words
        command = [sys.executable, "-S", "-m", *words]
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == code, f"{words}: {done.stdout[-3000:]}{done.stderr[-3000:]}"
        return done.stdout

    return tmp_path, run


@pytest.mark.slow(15)
def test_a_shape_is_one_file_and_its_test(checkout: tuple[Path, Run]) -> None:
    folder, run = checkout
    put_into(folder, "new-shape")
    registry = folder / "tests" / "testing" / "test_registry.py"
    line = re.search(r"`(\"stadium\": .*?,)`", read(EXAMPLES / "new-shape", "elements.md"))
    assert line
    text = registry.read_text(encoding="utf-8")
    registry.write_text(text.replace("SHAPE_EXAMPLES = {\n", f"SHAPE_EXAMPLES = {{\n    {line[1]}\n"), encoding="utf-8")
    run(["irsim", "schema", "--check"], 1)
    for words in commands(EXAMPLES / "new-shape"):
        told = run([*words, "-q", "-n0", "-p", "no:cacheprovider"] if words[0] == "pytest" else words)
        if words[0] == "pytest":
            assert " passed" in told
    run(["irsim", "schema", "--check"])
    assert "## stadium" in (folder / "skills/irsim-scenario/references/shapes.md").read_text(encoding="utf-8")
    assert "stadium" in run(["irsim", "describe", "shape.stadium"])
    shutil.copy(EXAMPLES / "new-shape" / "scenario.yaml", folder)
    assert json.loads(run(["irsim", "validate", "scenario.yaml", "--json"]))["findings"] == []
    assert json.loads(run(["irsim", "run", "scenario.yaml", "--seed", "1", "--json"]))["outcome"] == "success"
    assert "ends in **success**" in read(EXAMPLES / "new-shape", "elements.md")


@pytest.mark.slow(6)
def test_a_sensor_works_by_the_name_of_its_module(tmp_path: Path) -> None:
    folder = Path(shutil.copytree(EXAMPLES / "new-sensor", tmp_path / "copy"))
    for words in commands(EXAMPLES / "new-sensor"):
        told = execute(words, folder)
        if words[1] == "run":
            assert "arrived at 10 s" in told
    program = """
import beacons, irsim
env = irsim.make("scenario.yaml", display=False, log_level="ERROR", seed=1)
env.step()
print({name: round(distance, 2) for name, (distance, _) in env.robot.sensors[0].data.items()})
"""
    assert execute(["python", "-c", program], folder) == "{'obstacle_1': 2.7}\n"
    assert "at **2.70** m" in read(EXAMPLES / "new-sensor", "elements.md")
    text = (folder / "scenario.yaml").read_text(encoding="utf-8")
    (folder / "wrong.yaml").write_text(text.replace("reach: 4", "reech: 4"), encoding="utf-8")
    command = [sys.executable, "-m", "irsim", "validate", "wrong.yaml", "--import", "beacons"]
    done = subprocess.run(warm(command), cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "reach" in done.stdout + done.stderr


def test_a_sensor_is_found_by_its_entry_point(tmp_path: Path) -> None:
    folder = Path(shutil.copytree(EXAMPLES / "new-sensor", tmp_path / "copy"))
    declared = (folder / "pyproject.toml").read_text(encoding="utf-8")
    group, line = re.findall(r"entry-points\.\"(.+?)\"\]\n(.+)", declared)[0]
    info = folder / "irsim_beacons-0.1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: irsim-beacons\nVersion: 0.1.0\n", encoding="utf-8")
    (info / "entry_points.txt").write_text(f"[{group}]\n{line.replace(chr(34), '')}\n", encoding="utf-8")
    assert "success" in execute(["irsim", "run", "scenario.yaml", "--seed", "1"], folder)


@pytest.mark.rotates(4)
@pytest.mark.slow(80)
def test_a_behavior_is_two_files_and_its_test(tmp_path: Path) -> None:
    """Needs what compiles the core: it is built as for the user, who has the dependencies already."""
    copy, environment = tmp_path / "copy", Environment.create(tmp_path / "environment")
    copy.mkdir()
    copy_tree(copy)
    put_into(copy, "new-behavior")
    stub = copy / "irsim" / "_core.pyi"
    [part] = fences((EXAMPLES / "new-behavior" / "elements.md").read_text(encoding="utf-8"), "python")
    stub.write_text(stub.read_text(encoding="utf-8") + "\n" + part, encoding="utf-8")
    environment.share_libraries()

    def run(*words: str) -> str:
        return environment.run("python", *words, cwd=copy)

    run("-m", "pip", "install", "-q", "-e", ".[test]")
    for words in commands(EXAMPLES / "new-behavior")[1:]:
        run("-m", *(words[2:] if words[0] == "python" else words), *(["-q", "-n0"] if words[0] == "pytest" else []))
    shutil.copy(EXAMPLES / "new-behavior" / "scenario.yaml", copy)
    result = json.loads(run("-m", "irsim", "run", "scenario.yaml", "--seed", "1", "--json"))
    times = {robot["name"]: robot["time_to_goal"] for robot in result["robots"]}
    told = f"brisk after {times['brisk']:.1f} s, gentle after {times['gentle']:.1f} s"
    assert told in read(EXAMPLES / "new-behavior", "elements.md")


def test_the_files_of_features_exist() -> None:
    text = (SKILL / "references" / "features.md").read_text(encoding="utf-8")
    named = re.findall(r"`(irsim/[^`]+)`", text)
    assert len(named) > 30
    assert [name for name in named if not (ROOT / name).is_file()] == []
    for kind, registry in REGISTRIES.items():
        for feature in registry.features():
            if feature.origin == "built-in":
                assert f"| {kind} | `{feature.name}` |" in text


def test_files_and_folders_it_names_exist() -> None:
    named = {
        span
        for span in spans(BODY)
        if re.fullmatch(r"(irsim|tests|templates|schema|skills)/[\w./-]+|[A-Z]+\.md|pyproject\.toml|server\.json", span)
        and not re.search(r"\bx\b|/x\.|test_x", span)
    }
    assert len(named) > 12
    missing = [name for name in sorted(named) if not (ROOT / name).exists() and name != "SKILL.md"]
    assert missing == []
    assert codes.CODES


def test_the_steps_it_names_are_commands() -> None:
    noxfile = (ROOT / "noxfile.py").read_text(encoding="utf-8")
    for name in re.findall(r"`nox -s\s+([\w-]+)", BODY):
        assert f"def {name.replace('-', '_')}(" in noxfile
    assert (ROOT / "tests" / "mcp" / "golden" / "write.py").is_file()
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert "slow(seconds):" in project


def git(folder: Path, *words: str) -> None:
    command = ["git", "-c", "user.name=x", "-c", "user.email=x@example.org", *words]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)


def touched(folder: Path) -> tuple[int, dict[str, list[str]]]:
    return script(SKILL / "scripts" / "touched.py", str(folder), alone=True)


def test_the_script_names_the_steps_a_change_needs(tmp_path: Path) -> None:
    kept = ("irsim/core/step.cpp", "tests/core/test_dash.py", "CHANGELOG.md")
    for name in (*kept, "irsim/components/behaviors/dash.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("1\n", encoding="utf-8")
    git(tmp_path, "init", "-q")
    git(tmp_path, "add", "-A")
    git(tmp_path, "commit", "-qm", "x")
    assert touched(tmp_path) == (0, {"changed": [], "steps": [], "missing": []})
    (tmp_path / "irsim/components/behaviors/new.py").write_text("1\n", encoding="utf-8")
    code, told = touched(tmp_path)
    assert code == 1
    assert told["missing"] == ["a test", "a line in CHANGELOG.md"]
    assert {"irsim schema", "python -m irsim.lookup.reference"} <= set(told["steps"])
    assert "pip install -e ." not in told["steps"]
    for name in kept:
        (tmp_path / name).write_text("2\n", encoding="utf-8")
    code, told = touched(tmp_path)
    assert (code, told["missing"], told["steps"][0]) == (0, [], "pip install -e .")


def test_scenarios_of_the_examples_are_plain() -> None:
    for path in EXAMPLES.glob("*/scenario.yaml"):
        assert yaml.safe_load(path.read_text(encoding="utf-8"))["world"]["time_limit"]
