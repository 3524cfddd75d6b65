"""The page about recorded pedestrians: its commands work as written."""

from __future__ import annotations

import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from irsim.cli.app import app
from tests.bridges import crowds
from tests.skills.test_bridges import blocks


def test_its_commands_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "obsmat.txt").write_text(crowds.obsmat())
    (tmp_path / "crowd.vsp").write_text(crowds.vsp())
    np.savetxt(tmp_path / "H.txt", np.array([[0.02, 0, -7.2], [0, -0.02, 5.76], [0, 0, 1]]))
    commands = [line for block in blocks("pedestrians.md", "bash") for line in block.splitlines()]
    assert len(commands) == 9
    commands = [f"{command} --seeds 2" if command.startswith("irsim benchmark") else command for command in commands]
    for command in commands:
        done = CliRunner().invoke(app, shlex.split(command)[1:])
        assert done.exit_code == 0, (command, done.output)
    texts = {path.stem: path.read_text() for path in tmp_path.glob("*.yaml")}
    assert set(texts) == {"crowd", "crowd_suite", "zara", "corner", "part", "people", "short"}
    assert "robot:" not in texts["people"]
    places = [text[text.index("poses:") :].split("]")[0] for text in (texts["zara"], texts["corner"])]
    first = [np.array([float(v) for v in text.split("[[")[1].split(",")]) for text in places]
    np.testing.assert_allclose(*first, atol=1e-9)
