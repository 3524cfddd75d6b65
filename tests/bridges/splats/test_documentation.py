"""The page about splats: its commands work as written."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from irsim.bridges.frames import FRAMES, axes_of
from irsim.cli.app import app
from tests.bridges.splats.scenes import room, write_ply

PAGE = Path(__file__).resolve().parents[3] / "skills" / "irsim-runner" / "bridges" / "splats.md"


def test_all_commands_work_one_after_the_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_ply(tmp_path / "room.ply", room(spacing=0.12, axes=axes_of("colmap"), shift=(0, 1.2, 0)).columns)
    text = PAGE.read_text(encoding="utf-8")
    commands = [line for block in re.findall(r"```bash\n(.*?)```", text, re.DOTALL) for line in block.splitlines()]
    assert len(commands) == 9
    for command in commands:
        words = shlex.split(command, comments=True)[1:]
        if words[1] == "import":
            words += ["--resolution", "0.1"]
        if words[1] == "preview" and "width=320" not in words:
            words += ["--set", "width=60", "--set", "rows=40"]
        done = CliRunner().invoke(app, words)
        assert done.exit_code == 0, f"{command}\n{done.output}"
    written = {path.name for path in tmp_path.iterdir()}
    assert {"room.html", "room.png", "cameras", "dataset", "poses.jsonl", "run.gif", "step.png"} <= written


def test_all_frames_are_named() -> None:
    [listed] = re.findall(r"The frames are ([\w, ]+)\.", PAGE.read_text(encoding="utf-8"))
    assert set(re.split(r", | and ", listed)) == set(FRAMES)
