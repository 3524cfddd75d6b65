"""Each page about a bridge begins with commands that work in a clone: its first block, which is marked ``sh``."""

from __future__ import annotations

import importlib.util
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from irsim.cli.app import app
from tests.conftest import ROOT

FOLDER = ROOT / "skills" / "irsim-runner" / "bridges"
PAGES = sorted(page.stem for page in FOLDER.glob("*.md"))
MODULES = {"carla": "carla", "mesh": "trimesh", "mujoco": "mujoco", "ros2": "cyclonedds", "usd": "pxr"}
"""Module of each extra that a page installs first."""


def try_page(name: str) -> None:
    """Run the first block of a page in the current folder; without its extra, commands say which one is missing."""
    text = (FOLDER / f"{name}.md").read_text(encoding="utf-8")
    first = re.search(r"^```(\w+)\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    assert first is not None, f"{name}.md has no commands"
    assert first[1] == "sh", f"{name}.md does not begin with commands for a clone"
    missing = None
    for line in first[2].splitlines():
        words = shlex.split(line, comments=True)
        if words[0] == "pip":
            [extra] = re.findall(r"^\.\[(\w+)\]$", words[3])
            assert words[:3] == ["pip", "install", "-e"]
            assert re.search(rf"^{extra} = \[", (ROOT / "pyproject.toml").read_text(encoding="utf-8"), re.MULTILINE)
            missing = extra if importlib.util.find_spec(MODULES[extra]) is None else None
        elif words[0] == "python3":
            subprocess.run([sys.executable, ROOT / words[1], *words[2:]], check=True, capture_output=True)
        else:
            assert words[0] == "irsim"
            done = CliRunner().invoke(app, words[1:])
            if missing and done.exit_code:
                assert f"irsim-mcp[{missing}]" in done.output, (line, done.output)
                return
            assert done.exit_code == 0, (line, done.output)


@pytest.mark.parametrize("page", PAGES)
def test_a_page_begins_with_commands_that_work(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    try_page(page)
