"""The three lines with which the guide on learning opens a task in each library run, and say what they lack."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from irsim.learning.tasks.files import TASKS
from tests.skills.conftest import ROOT, fences

GUIDE = (ROOT / "skills" / "irsim-runner" / "guides" / "learning.md").read_text(encoding="utf-8")
PROGRAMS = {
    re.findall(r"\w+", program)[4]: program for program in fences(GUIDE, "python") if "irsim.learning" in program
}
"""Class of :mod:`irsim.learning` -> the program of the guide that uses it."""
STEPS = """
env.reset(seed=0)
env.step([1.0, 0.0])
env.close()
"""


def run(program: str, folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", program]  # not a warm one, which has imported the libraries
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=240)


def test_the_guide_has_three_lines_for_each_library() -> None:
    assert list(PROGRAMS) == ["SB3VecEnv", "TorchRLEnv", "Env"]
    assert {len(program.strip().splitlines()) for program in PROGRAMS.values()} == {3}
    assert "goal_lidar" in TASKS.names()


@pytest.mark.parametrize(
    ("name", "library", "extra"),
    [("SB3VecEnv", "stable_baselines3", "learn"), ("TorchRLEnv", "torchrl", "learn"), ("Env", "gymnasium", "gym")],
)
def test_without_its_library_the_first_line_says_which_extra(
    name: str, library: str, extra: str, tmp_path: Path
) -> None:
    done = run(f"import sys\nsys.modules[{library!r}] = None\n{PROGRAMS[name]}", tmp_path)
    assert done.returncode == 1
    assert "missing-extra" in done.stderr
    assert f"pip install 'irsim-mcp[{extra}]'" in done.stderr


@pytest.mark.learn
@pytest.mark.parametrize("name", list(PROGRAMS))
def test_the_three_lines_run(name: str, tmp_path: Path) -> None:
    done = run(PROGRAMS[name] + (STEPS if name == "Env" else ""), tmp_path)
    assert done.returncode == 0, done.stderr
    if name == "Env":
        assert (tmp_path / "videos" / "rl-video-episode-0.mp4").stat().st_size > 1000
