"""The command line, called in the process and as a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from tests.warm import warm

Run = Callable[..., Result]
Spawn = Callable[..., "subprocess.CompletedProcess[str]"]

ROOM = """\
world: {width: 8, height: 6}
robot:
  - kinematics: {name: diff}
    shape: {name: circle, radius: 0.3}
    state: [1, 1, 0]
    goal: [4, 3, 0]
    behavior: {name: dash}
"""

CRASH = ROOM.replace("goal: [4, 3, 0]", "goal: [7, 1, 0]") + (
    "obstacle:\n  - {shape: {name: circle, radius: 0.5}, state: [4, 1, 0]}\n"
)


@pytest.fixture(autouse=True)
def _in_tmp_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def irsim() -> Run:
    """``irsim("run", "room.yaml")`` inside this process: quick; with ``code``, it must end with that code."""
    from irsim.cli.app import app

    def call(*words: str, code: int | None = None, **options: Any) -> Result:
        result = CliRunner().invoke(app, [str(word) for word in words], **options)
        assert "Traceback" not in result.output
        assert code in (None, result.exit_code), result.output
        return result

    return call


@pytest.fixture
def spawn(tmp_path: Path) -> Spawn:
    """The same as a process, as users run it."""

    def call(*words: str, **options: Any) -> subprocess.CompletedProcess[str]:
        options.setdefault("cwd", tmp_path)
        options.setdefault("timeout", 60)
        environment = {**os.environ, "COLUMNS": "100"}
        return subprocess.run(
            warm([sys.executable, "-m", "irsim", *map(str, words)]),
            capture_output=True,
            text=True,
            check=False,
            env=environment,
            **options,
        )

    return call


@pytest.fixture
def room(tmp_path: Path) -> Path:
    """A robot that arrives."""
    path = tmp_path / "room.yaml"
    path.write_text(ROOM, encoding="utf-8")
    return path


@pytest.fixture
def crash(tmp_path: Path) -> Path:
    """A robot that collides."""
    path = tmp_path / "crash.yaml"
    path.write_text(CRASH, encoding="utf-8")
    return path


def parsed(result: Result) -> Any:
    """Standard output, which must be one JSON document and nothing else."""
    return json.loads(result.stdout)
