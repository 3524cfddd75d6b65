"""Policies that are files, and suites that are not bundled, in the audit of a submission."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from irsim.api.audit_submission import audit_submission
from irsim.cli.app import app
from irsim.common.hashing import file_digest
from irsim.diagnostics.errors import InputError
from irsim.policies.trained import trained_policy

SUITE = """\
suite: mine_v1
version: 1
title: One robot
seconds: 3
seeds: {count: 2}
policies: {dash: dash}
scenarios:
  - name: alone
    scenario:
      world: {width: 6, height: 6}
      robot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [2, 1, 0]}
"""


def submit(*words: str, folder: Path) -> Path:
    """A submission of a few episodes."""
    done = CliRunner().invoke(app, ["benchmark", *words, "--submission", str(folder), "--workers", "1"])
    assert done.exit_code == 0, done.output
    return folder


@pytest.fixture
def with_network(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A submission of a network of its author, read in another folder than it was written in."""
    author, reader = tmp_path / "author", tmp_path / "reader"
    author.mkdir()
    reader.mkdir()
    monkeypatch.chdir(author)
    shutil.copy(trained_policy("multi_robot_v2"), "mine.npz")
    words = ["random_polygons_v2", "--policies", "dash,mine.npz", "--scenario", "robots-5", "--protocol", "freeze"]
    folder = submit(*words, "--seeds", "1", folder=tmp_path / "entry")
    monkeypatch.chdir(reader)
    return folder


def without_network(folder: Path) -> Path:
    """The submission without the file of its network."""
    shutil.rmtree(folder / "policies")
    manifest = folder / "submission.json"
    data = json.loads(manifest.read_text(encoding="utf-8"))
    data["files"] = {name: known for name, known in data["files"].items() if not name.startswith("policies/")}
    manifest.write_text(json.dumps(data), encoding="utf-8")
    return folder


def test_a_network_that_the_submission_holds_is_run_again(with_network: Path) -> None:
    result = audit_submission(with_network, replay="all", workers=1)
    assert result.equal, result.problems
    assert (result.replayed, result.not_replayed) == (2, [])


def test_a_network_that_is_missing_is_said_and_may_be_given(with_network: Path, tmp_path: Path) -> None:
    folder = without_network(with_network)
    result = audit_submission(folder, replay="all", workers=1)
    assert result.equal, result.problems
    assert result.replayed == 1
    assert result.not_replayed == [
        "1 episode of mine.npz not replayed: its file is not here; give it with --policy mine.npz=FILE"
    ]
    assert any(note.startswith("what the policy mine.npz knows is what its author says") for note in result.notes)
    assert {row.policy: row.replayed for row in result.leaderboard} == {"dash": 1, "mine.npz": 0}
    given = {"mine.npz": tmp_path / "author" / "mine.npz"}
    result = audit_submission(folder, replay="all", policies=given, workers=1)
    assert (result.equal, result.replayed, result.notes) == (True, 2, [])


def test_another_network_is_not_run(with_network: Path) -> None:
    given = {"mine.npz": trained_policy("multi_robot")}
    result = audit_submission(without_network(with_network), policies=given)
    assert [problem.code for problem in result.problems] == ["submission-suite"]
    assert result.problems[0].message == "the policy mine.npz that is here has another hash than the one of the plan"
    with pytest.raises(InputError, match="has no policy yours"):
        audit_submission(with_network, policies={"yours": trained_policy("multi_robot")})


def test_a_network_that_was_exchanged_is_a_changed_file(with_network: Path) -> None:
    [file] = (with_network / "policies").iterdir()
    shutil.copy(trained_policy("multi_robot"), file)
    [problem] = audit_submission(with_network).problems
    assert (problem.code, problem.path) == ("submission-file", f"policies/{file.name}")
    manifest = with_network / "submission.json"
    data = json.loads(manifest.read_text(encoding="utf-8"))
    data["files"][f"policies/{file.name}"] = file_digest(file)
    manifest.write_text(json.dumps(data), encoding="utf-8")
    assert audit_submission(with_network, replay="all", workers=1).replayed == 1  # as if it were missing


def test_a_suite_of_ones_own_is_checked_with_its_file(tmp_path: Path) -> None:
    suite = tmp_path / "mine.yaml"
    suite.write_text(SUITE, encoding="utf-8")
    folder = submit(str(suite), folder=tmp_path / "entry")
    [problem] = audit_submission(folder).problems
    assert problem.code == "submission-suite"
    assert problem.message.endswith("has no suite mine_v1, so nothing of it can be checked")
    assert "--suite FILE" in str(problem.fix)
    result = audit_submission(folder, suite=suite, replay="all", workers=1)
    assert result.equal, result.problems
    suite.write_text(SUITE.replace("goal: [2, 1, 0]", "goal: [3, 1, 0]"), encoding="utf-8")
    [problem] = audit_submission(folder, suite=suite).problems
    assert problem.message.startswith("the suite is not mine_v1 of irsim")


def test_arguments_of_the_command(tmp_path: Path) -> None:
    suite = tmp_path / "mine.yaml"
    suite.write_text(SUITE, encoding="utf-8")
    folder = submit(str(suite), folder=tmp_path / "entry")
    done = CliRunner().invoke(app, ["audit", str(folder), "--suite", str(suite), "--replay", "all", "--salt", "a"])
    assert done.exit_code == 0, done.output
    assert "1 of 1 drawn episodes were run again (salt a) and are equal" in done.output
    for words, cause in (
        (["--replay", "0"], "--replay takes a number from 1 on or all, got 0"),
        (["--replay", "some"], "got some"),
        (["--salt", "a"], "salt draws the episodes that are run again"),
        (["--policy-file", "mine.npz"], "--policy-file takes NAME=FILE, got mine.npz"),
    ):
        done = CliRunner().invoke(app, ["audit", str(folder), *words])
        assert (done.exit_code, cause in done.output.replace("\n", " ")) == (2, True), done.output
