"""What the table in the terminal says about shares and times."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from irsim.cli.app import app

ARRIVES = "robot:\n  - {state: [1, 1], goal: [2, 1], kinematics: {name: diff}, behavior: {name: dash}}\n"
STANDS = "  - {state: [5, 5], goal: [9, 5], kinematics: {name: diff}}\n"


def test_times_beside_failures_are_those_of_robots_that_arrived(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    told = {}
    for name, text in (("all", ARRIVES), ("one", ARRIVES + STANDS)):
        Path(f"{name}.yaml").write_text(text, encoding="utf-8")
        told[name] = CliRunner().invoke(app, ["benchmark", f"{name}.yaml"]).stdout
    assert "time: of the robots that arrived, in any episode" in told["one"]
    assert "of the robots that arrived" not in told["all"]
