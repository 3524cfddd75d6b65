"""``irsim run --seeds``: a table of the episodes, and how to look at the first that failed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from irsim.cli.app import app
from tests.mcp.test_run_seeds import CROWD


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "crowd.yaml").write_text(CROWD, encoding="utf-8")


def test_the_table_has_a_row_for_each_seed_and_the_first_failure_can_be_drawn() -> None:
    shown = CliRunner().invoke(app, ["run", "crowd.yaml", "--seeds", "0..2"])
    assert shown.exit_code == 0, shown.output
    rows = [line.split()[:2] for line in shown.stdout.splitlines()[1:4]]
    assert rows[0] == ["0", "collision"]
    assert "episodes succeeded; failed: collision: seeds 0, 1" in shown.stdout
    look = next(line for line in shown.stdout.splitlines() if line.startswith("look: "))
    drawn = CliRunner().invoke(app, look.removeprefix("look: irsim ").split())
    assert drawn.exit_code == 0, drawn.output
    assert Path("failed.png").stat().st_size > 1000
    assert "reproduce: irsim run crowd.yaml --seed 0" in shown.stdout


def test_a_failure_under_disturbances_is_recorded_before_it_is_drawn() -> None:
    shown = CliRunner().invoke(app, ["run", "crowd.yaml", "--seeds", "1", "--perturb", "delay=1"])
    look = next(line for line in shown.stdout.splitlines() if line.startswith("look: "))
    for command in look.removeprefix("look: ").split(" && "):
        done = CliRunner().invoke(app, command.split()[1:])
        assert done.exit_code == 0, done.output
    assert Path("failed.png").stat().st_size > 1000


def test_json_has_the_episodes_and_their_number_counts_for_success() -> None:
    told = CliRunner().invoke(app, ["run", "crowd.yaml", "--seeds", "2", "--json", "--require-success"])
    assert told.exit_code == 1
    data = json.loads(told.stdout)
    assert [one["seed"] for one in data["episodes"]] == [0, 1]
    assert data["failed"] == {"collision": [0, 1]}


@pytest.mark.parametrize("words", [["--seed", "3"], ["--save-gif", "a.gif"], ["--show"], ["--export", "a.npz"]])
def test_options_of_a_single_run_are_refused(words: list[str]) -> None:
    refused = CliRunner().invoke(app, ["run", "crowd.yaml", "--seeds", "2", *words])
    assert refused.exit_code == 2
    assert words[0] in refused.output
