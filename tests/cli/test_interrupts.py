"""Ctrl-C in a long command: no traceback, no partial file, and a line with the command that goes on."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.cli.conftest import Run

pytestmark = [
    pytest.mark.one_python,
    pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX"),
    pytest.mark.usefixtures("interruptible"),
]
SCRIPT = Path(__file__).with_name("ctrl_c.py")
SUITE = """
suite: easy
version: 1
title: One robot
scenarios:
  - name: robot
    scenario: {robot: {kinematics: {name: diff}, state: [1, 1], goal: [2, 1], distribution: {name: random}}}
seeds: {count: 12}
steps: 300
policies: {dash: dash}
"""
HOUSE = [[[0, 0], [0.0002, 0], [0.0002, 0.0001], [0, 0.0001], [0, 0]]]
TOWN = {
    "type": "FeatureCollection",
    "features": [{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": HOUSE}}],
}
TASK = """
task: hall
scenario: {robot: {kinematics: {name: diff}, state: [1, 1], goal: [4, 1]}}
horizon: 5
observation: [{name: goal}]
reward: [{name: progress}]
seeds: {validation_count: 4}
"""


def interrupted(folder: Path, moment: object, *words: str) -> str:
    """The message of an interrupted command, which is all that it writes to standard error."""
    command = [sys.executable, str(SCRIPT), str(moment), *words]
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=False, start_new_session=True, timeout=120
    )
    assert done.returncode == 130, done.stderr
    assert "Traceback" not in done.stdout + done.stderr
    [said] = done.stderr.splitlines()
    assert said.startswith("interrupted; ")
    return said


def follow(folder: Path, said: str) -> None:
    """Type the command that was said; it must finish."""
    words = shlex.split(re.split(r"(?:go on|again|kept): (?=irsim )", said)[1])
    done = subprocess.run(
        [sys.executable, "-m", *words], cwd=folder, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr


def tree(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if "__pycache__" not in path.parts)


@pytest.mark.parametrize("workers", ["1", "2"])
def test_an_interrupted_benchmark_says_how_it_goes_on(workers: str, tmp_path: Path) -> None:
    (tmp_path / "easy.yaml").write_text(SUITE, encoding="utf-8")
    said = interrupted(tmp_path, 16, "benchmark", "easy.yaml", "-o", "full run", "--workers", workers)
    assert said.endswith(f"go on: irsim benchmark --resume -o 'full run' --workers {workers}")
    episodes = tmp_path / "full run" / "episodes.jsonl"  # its first line is about all of them
    assert 1 < len(episodes.read_text(encoding="utf-8").splitlines()) < 13
    follow(tmp_path, said)
    assert len(episodes.read_text(encoding="utf-8").splitlines()) == 13
    assert (tmp_path / "full run" / "results.json").is_file()


@pytest.mark.parametrize("module", ["irsim.cli.benchmark", "irsim.benchmarks.stored", "numpy"])
def test_an_interrupted_start_says_the_command_itself(module: str, tmp_path: Path) -> None:
    (tmp_path / "easy.yaml").write_text(SUITE, encoding="utf-8")
    said = interrupted(tmp_path, module, "benchmark", "easy.yaml", "-o", "full")
    assert said == "interrupted; again: irsim benchmark easy.yaml -o full"
    assert tree(tmp_path) == ["easy.yaml"]


def test_a_benchmark_without_a_folder_says_how_episodes_are_kept(room: Path, tmp_path: Path) -> None:
    (tmp_path / "press.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGINT)\n", encoding="utf-8")
    said = interrupted(tmp_path, "never", "benchmark", "room.yaml", "--seeds", "1", "--import", "press")
    assert said == "interrupted; again: irsim benchmark room.yaml --seeds 1 --import press"
    said = interrupted(tmp_path, "irsim.scenario.checks.braking", "benchmark", "room.yaml", "--seeds", "1")
    assert said.endswith("again, and kept: irsim benchmark room.yaml --seeds 1 -o results")


@pytest.mark.parametrize("moment", [1, 2, 3])
@pytest.mark.parametrize("file", ["run.csv", "run.npz"])
def test_an_interrupted_export_leaves_no_file(file: str, moment: int, irsim: Run, room: Path, tmp_path: Path) -> None:
    irsim("run", "room.yaml", "--record-to", "kept", code=0)
    before = tree(tmp_path)
    said = interrupted(tmp_path, moment, "export", "kept", "-o", file)
    assert said == f"interrupted; nothing was written; again: irsim export kept -o {file}"
    assert tree(tmp_path) == before
    follow(tmp_path, said)
    assert (tmp_path / file).is_file()


@pytest.mark.parametrize("moment", [1, 3, 5, 7])
def test_an_interrupted_import_of_a_map_leaves_no_file(moment: int, tmp_path: Path) -> None:
    (tmp_path / "town.geojson").write_text(json.dumps(TOWN), encoding="utf-8")
    said = interrupted(tmp_path, moment, "map", "import", "town.geojson", "-o", "maps/scene.yaml")
    assert said == "interrupted; nothing was written; again: irsim map import town.geojson -o maps/scene.yaml"
    assert [name for name in tree(tmp_path) if name not in ("maps", "town.geojson")] == []
    follow(tmp_path, said)
    assert (tmp_path / "maps" / "scene.yaml").is_file()


@pytest.mark.learn
@pytest.mark.parametrize("workers", ["1", "2"])
def test_an_interrupted_training_says_how_it_goes_on(workers: str, tmp_path: Path) -> None:
    (tmp_path / "task.yaml").write_text(TASK, encoding="utf-8")
    few = ["--set", "slots=8", "--set", "rollout=16", "--set", "round_updates=1", "--decisions", "1200"]
    said = interrupted(tmp_path, 60, "train", "task.yaml", "-o", "taught", *few, "--workers", workers)
    more = " --workers 2" if workers == "2" else ""
    assert said.endswith(f"go on: irsim train --resume -o taught{more}")
    follow(tmp_path, said)
    assert (tmp_path / "taught" / "best.zip").is_file()


@pytest.mark.learn
@pytest.mark.parametrize("moment", [20, 24])
def test_a_training_without_a_finished_round_begins_again(moment: int, tmp_path: Path) -> None:
    (tmp_path / "task.yaml").write_text(TASK, encoding="utf-8")
    few = ["--set", "slots=8", "--set", "rollout=16", "--set", "round_updates=1", "--decisions", "300"]
    said = interrupted(tmp_path, moment, "train", "task.yaml", "-o", "taught", *few)
    assert said.startswith("interrupted; no round was finished; again: irsim train task.yaml -o taught --set slots=8")
    follow(tmp_path, said)
    assert (tmp_path / "taught" / "best.zip").is_file()


@pytest.mark.usefixtures("ordinary_processes")
@pytest.mark.parametrize("after", [0.0, 0.8, 1.1, 2.0])
def test_ctrl_c_at_a_terminal_reaches_all_processes_and_one_answers(after: float, tmp_path: Path) -> None:
    """A terminal sends the signal to the whole group, at whatever the processes of a benchmark do: start, or run."""
    (tmp_path / "easy.yaml").write_text(SUITE.replace("count: 12", "count: 20000"), encoding="utf-8")
    command = [sys.executable, "-m", "irsim", "benchmark", "easy.yaml", "-o", "kept", "--workers", "3"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True, start_new_session=True) as begun:
        while not (tmp_path / "kept" / "episodes.jsonl").exists():
            assert begun.poll() is None
            time.sleep(0.02)
        time.sleep(after)
        os.killpg(begun.pid, signal.SIGINT)
        _, said = begun.communicate(timeout=60)
    assert begun.returncode == 130
    assert "Traceback" not in said
    assert said.splitlines()[-1].startswith("interrupted; ")
