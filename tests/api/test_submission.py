"""A submission is complete and checks itself; every change of it becomes a problem with the path of its file."""

from __future__ import annotations

import csv
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from irsim.api.audit_submission import audit_all, audit_submission
from irsim.benchmarks.submission import SAMPLED, sampled_episodes
from irsim.cli.app import app
from irsim.common.hashing import file_digest
from irsim.results.audit import SubmissionAudit

ARGUMENTS = ["benchmark", "clutter_v2", "--policies", "dash,orca", "--scenario", "posts-15", "--seeds", "2"]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A submission, which no test changes."""
    folder = tmp_path_factory.mktemp("submitted") / "mine"
    done = CliRunner().invoke(app, [*ARGUMENTS, "--submission", str(folder), "--workers", "1"])
    assert done.exit_code == 0, done.output
    return folder


@pytest.fixture
def submission(written: Path, tmp_path: Path) -> Path:
    """A copy of it."""
    return Path(shutil.copytree(written, tmp_path / "mine"))


def change(path: Path, how: Callable[[Any], None], *, sign: bool = False) -> None:
    """Change a JSON file; with ``sign`` the manifest gets its new digest."""
    data = json.loads(path.read_text(encoding="utf-8"))
    how(data)
    path.write_text(json.dumps(data), encoding="utf-8")
    if sign:
        resign(path)


def resign(path: Path) -> None:
    """Give the manifest the digest of a changed file."""
    folder = next(parent for parent in path.parents if (parent / "submission.json").exists())
    name = path.relative_to(folder).as_posix()
    change(folder / "submission.json", lambda data: data["files"].update({name: file_digest(path)}))


def problems(result: SubmissionAudit) -> set[tuple[str, str]]:
    """Code and path of each problem."""
    return {(problem.code, problem.path) for problem in result.problems}


def test_a_submission_is_equal_and_has_a_leaderboard(written: Path) -> None:
    result = audit_submission(written)
    assert result.equal, result.problems
    assert result.sampled == result.episodes
    assert {row.policy for row in result.leaderboard} == {"dash", "orca"}
    manifest = json.loads((written / "submission.json").read_text(encoding="utf-8"))
    assert manifest["suite"] == "clutter_v2"
    assert {"irsim", "python", "numpy", "engine", "suite_hash", "policies", "seeds"} <= set(manifest)
    with (written / "rows.csv").open(encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == result.episodes


def test_the_leaderboard_breaks_no_word_in_80_columns(written: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    audited = audit_all([written])
    [row, *_] = audited.submissions[0].leaderboard
    long = {"success": 1.0, "low": 1.0, "high": 1.0, "collision": 1.0, "time_to_goal": 123.45}
    rows = [
        row.model_copy(update={"scenes": scenes, "policy": policy, **long})
        for scenes in ("corridor-social", "evacuation-of-a-long-name")
        for policy in ("footprint_orca", "sarl_multi_robot")
    ]
    salted = audited.submissions[0].model_copy(update={"leaderboard": rows, "salt": "abc"})
    shown = audited.model_copy(update={"submissions": [salted]})
    monkeypatch.setattr("irsim.cli.audit.audit_all", lambda *_, **__: shown)
    monkeypatch.setenv("COLUMNS", "80")
    lines = CliRunner().invoke(app, ["audit", str(written)]).stdout.splitlines()
    for name in ("footprint_orca", "sarl_multi_robot"):
        told = [line for line in lines if line.startswith(name)]
        assert len(told) == 2
        assert all("100.0% to 100.0%" in line and "123.45" in line and len(line) <= 80 for line in told)
    assert {"corridor-social", "evacuation-of-a-long-name"} <= {line.strip() for line in lines}


def test_the_sample_is_decided_by_the_plan() -> None:
    episodes = [("a", "dash", seed) for seed in range(100)]
    chosen = sampled_episodes("1234", episodes)
    assert len(chosen) == SAMPLED
    assert chosen == sampled_episodes("1234", episodes[::-1])
    assert chosen != sampled_episodes("1235", episodes)


def test_a_changed_file_is_named(submission: Path) -> None:
    with (submission / "rows.csv").open("a", encoding="utf-8") as file:
        file.write("more\n")
    assert problems(audit_submission(submission)) == {("submission-file", "rows.csv")}


def test_a_better_rate_needs_better_episodes(submission: Path) -> None:
    change(submission / "results.json", lambda data: data["rows"][0]["success"].update(rate=0.99), sign=True)
    assert problems(audit_submission(submission)) == {("submission-table", "results.json")}


def test_a_missing_and_a_second_row_are_found(submission: Path) -> None:
    change(submission / "results.json", lambda data: data["episodes"].append(data["episodes"].pop(0)), sign=True)
    change(submission / "results.json", lambda data: data["episodes"].append(data["episodes"].pop(0)), sign=True)

    def twice(data: Any) -> None:
        data["episodes"][0] = data["episodes"][1]

    change(submission / "results.json", twice, sign=True)
    texts = [problem.message for problem in audit_submission(submission).problems]
    assert any("is missing" in text for text in texts)
    assert any("has 2 rows" in text for text in texts)


def test_a_row_that_its_record_contradicts_is_found(submission: Path) -> None:
    def shorter(data: Any) -> None:
        for episode in data["episodes"]:
            episode["metrics"]["path_length"] *= 0.9

    change(submission / "results.json", shorter, sign=True)
    odd = problems(audit_submission(submission))
    assert ("submission-run", "runs/00") in odd
    assert ("submission-table", "results.json") in odd


def test_a_record_that_was_changed_is_found(submission: Path) -> None:
    path = submission / "runs" / "01" / "result.json"
    change(path, lambda data: data["robots"][0].update(path_length=1.0), sign=True)
    result = audit_submission(submission)
    assert problems(result) == {("submission-run", "runs/01")}
    assert result.runs[0].findings[0].code == "audit-metric"


def test_a_record_of_another_seed_is_found(submission: Path) -> None:
    path = submission / "runs" / "00" / "run.json"
    change(path, lambda data: data.update(seed=7), sign=True)
    assert problems(audit_submission(submission)) == {("submission-origin", "runs/00")}


def test_another_scenario_is_none_of_the_suite(submission: Path) -> None:
    def easier(data: Any) -> None:
        data["scenarios"][0]["text"] = data["scenarios"][0]["text"].replace("goal_threshold: 0.3", "goal_threshold: 3")
        data["seeds"] = data["seeds"][::-1]

    change(submission / "plan.json", easier, sign=True)
    assert ("bad-submission", "submission.json") in problems(audit_submission(submission))


@pytest.mark.parametrize("name", ["../outside.json", "/etc/passwd", "runs/../../outside.json", "C:\\x", "runs\\00"])
def test_paths_that_lead_elsewhere_are_not_read(submission: Path, name: str) -> None:
    (submission.parent / "outside.json").write_text("{}", encoding="utf-8")
    change(submission / "submission.json", lambda data: data["files"].update({name: "0" * 64}))
    [problem] = audit_submission(submission).problems
    assert problem.code == "submission-file"
    assert problem.message == "it does not name a file within the folder"
    assert problem.fix


def test_links_and_pipes_are_not_followed(submission: Path) -> None:
    rows = submission / "rows.csv"
    rows.rename(submission.parent / "rows.csv")
    rows.symlink_to(submission.parent / "rows.csv")
    assert problems(audit_submission(submission)) == {("submission-file", "rows.csv")}
    rows.unlink()
    os.mkfifo(rows)
    assert problems(audit_submission(submission)) == {("submission-file", "rows.csv")}


@pytest.mark.parametrize("content", [b"", b"{", b"[1, 2]", b"\xff\xfe", b'{"format": 1}', b"[" * 100_000])
@pytest.mark.parametrize("name", ["submission.json", "plan.json", "results.json"])
def test_damaged_files_are_problems(submission: Path, name: str, content: bytes) -> None:
    (submission / name).write_bytes(content)
    if name != "submission.json":
        resign(submission / name)
    result = audit_submission(submission)
    assert not result.equal
    assert name in {problem.path for problem in result.problems}


def test_an_unlisted_file_is_found(submission: Path) -> None:
    (submission / "runs" / "00" / "more.bin").write_bytes(b"x")
    assert problems(audit_submission(submission)) == {("submission-file", "runs/00/more.bin")}


def test_runs_and_submissions_are_audited_together(written: Path) -> None:
    result = audit_all([written, written / "runs" / "00"])
    assert result.equal
    assert (len(result.runs), len(result.submissions)) == (1, 1)


def test_the_command(written: Path, tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["audit", str(written), "--json"])
    assert done.exit_code == 0
    assert json.loads(done.stdout)["equal"]
    done = CliRunner().invoke(app, ["audit", str(tmp_path / "nothing")])
    assert done.exit_code == 1
    assert "unknown-run" in done.output
    (tmp_path / "results").mkdir()
    done = CliRunner().invoke(app, ["audit", str(tmp_path / "results")])
    assert done.exit_code == 2
    assert "neither a submission (submission.json) nor a recorded run (run.json)" in done.output
    assert "irsim benchmark SUITE --submission DIR" in done.output
    done = CliRunner().invoke(app, ["benchmark", "x.yaml", "--submission", str(tmp_path / "new")])
    assert done.exit_code == 2
    assert "belongs to a suite" in done.output


@pytest.mark.parametrize(
    ("suite", "policy", "scenario"), [("social_v2", "as-written", "head-on"), ("maps_v2", "astar", "forest-1-0.15")]
)
def test_perturbed_scenes_and_maps_are_drawn_again(suite: str, policy: str, scenario: str, workspace: Path) -> None:
    words = ["benchmark", suite, "--policies", policy, "--scenario", scenario, "--seeds", "1"]
    done = CliRunner().invoke(app, [*words, "--submission", "mine", "--workers", "1"])
    assert done.exit_code == 0, done.output
    result = audit_submission("mine", replay="all", workers=1)
    assert result.equal, result.problems
    assert result.replayed == result.sampled == result.episodes


def test_policies_that_share_a_scene_are_recorded_as_they_were_compared(workspace: Path) -> None:
    words = ["benchmark", "mixed_v2", "--policies", "avocado", "--scenario", "one-rl_rvo", "--seeds", "1"]
    done = CliRunner().invoke(app, [*words, "--submission", "mine", "--workers", "1"])
    assert done.exit_code == 0, done.output
    result = audit_submission("mine")
    assert result.equal, result.problems
    assert result.sampled == 1
