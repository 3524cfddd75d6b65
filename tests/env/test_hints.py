"""An environment says some things once, on standard error: how its steps are seen, and hints about its scenario."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import irsim
from tests.cli.conftest import ROOM
from tests.warm import warm

LOOP = """
for _ in range({steps}):
    env.step()
env.end(0)
"""


def run(program: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    (folder / "room.yaml").write_text(ROOM, encoding="utf-8")
    kept = {key: value for key, value in os.environ.items() if key not in ("MPLBACKEND", "DISPLAY", "WAYLAND_DISPLAY")}
    return subprocess.run(
        warm([sys.executable, "-c", "import irsim\n" + program]), cwd=folder, env={**kept, **variables},
        capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="a variable names the screen")
@pytest.mark.parametrize("steps", [3, 60])
def test_steps_that_no_window_shows_say_once_what_to_call(steps: int, tmp_path: Path) -> None:
    loop = LOOP.format(steps=steps)
    twice = f"env = irsim.make('room.yaml', display=True){loop}env = irsim.make('room.yaml'){loop}"
    done = run(twice, tmp_path, DISPLAY=":4711")  # no window is opened there
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("env.render()") == 1
    assert "display=False" in done.stderr
    assert "render" not in done.stdout


@pytest.mark.parametrize(
    ("program", "variables"),
    [
        ("env = irsim.make('room.yaml')", {}),
        ("env = irsim.make('room.yaml', display=False)", {"DISPLAY": ":4711"}),
        ("env = irsim.make('room.yaml', headless=True)", {"DISPLAY": ":4711"}),
        ("env = irsim.make('room.yaml', log_level='WARNING')", {"DISPLAY": ":4711"}),
    ],
    ids=["no screen", "no display", "headless", "quiet"],
)
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="a variable names the screen")
def test_who_wants_no_window_is_told_nothing(program: str, variables: dict[str, str], tmp_path: Path) -> None:
    done = run(program + LOOP.format(steps=30), tmp_path, **variables)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("word", "meant"),
    [
        ("dispaly", "display"),
        ("Seed", "seed"),
        ("world", "world_name"),
        ("save_anim", "save_ani"),
        ("loglevel", "log_level"),
    ],
)
def test_a_misspelt_argument_is_answered_with_the_right_one(word: str, meant: str) -> None:
    wrong: Any = {word: 1}
    with pytest.raises(TypeError, match=rf"make\(\) .* '{word}'\. Did you mean '{meant}'\?"):
        irsim.make("room.yaml", **wrong)
