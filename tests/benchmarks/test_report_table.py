"""Tables of benchmarks: the words of the one in the terminal, and the file of episodes without its library."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from irsim.cli.app import app

SCENE = "robot: {state: [1, 1], goal: [2, 1], behavior: {name: dash}}\n"


def test_without_the_library_terminal_and_report_say_how_to_get_the_table(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("irsim.benchmarks.report.table.find_spec", lambda name: None)
    monkeypatch.chdir(tmp_path)
    Path("a.yaml").write_text(SCENE, encoding="utf-8")
    done = CliRunner().invoke(app, ["benchmark", "a.yaml", "-o", "run"])
    assert done.exit_code == 0
    line = "results.parquet was not written: pyarrow is not installed (pip install 'irsim-mcp[records]')"
    assert f"note: {line}" in done.stderr.splitlines()
    assert f"Note: {line}" in Path("run/results.md").read_text(encoding="utf-8")
    assert not Path("run/results.parquet").exists()


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
