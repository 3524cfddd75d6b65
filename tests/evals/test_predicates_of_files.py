"""Predicates about files that the agent left: values in JSON, output of commands, edits of a named file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from irsim_evals.grader.material import Material
from irsim_evals.grader.predicates.files import Command, Data, Edits

RESULT = '{"rows": [{"n": 20, "name": "orca"}, {"n": 20, "name": "dash"}], "ok": true, "none": null}'


def left(files: dict[str, str], given: dict[str, str] | None = None, folder: Path | None = None) -> Material:
    return Material(scenario=None, selectors={}, texts=files, given=given or {}, trusted_folder=folder)


@pytest.mark.parametrize(
    ("has", "passes"),
    [
        ({"rows[*].n": 20}, True),
        ({"rows[1].name": "dash", "ok": True}, True),
        ({"rows": {"given": True}}, True),
        ({"rows[*].n": 21}, False),
        ({"rows[*].name": "orca"}, False),  # every value counts
        ({"rows[2].n": 20}, False),
        ({"rows.n": 20}, False),
        ({"columns[*].n": {"le": 100}}, False),  # nothing there is nothing right
        ({"ok": 1}, False),
    ],
)
def test_values_of_a_file(has: dict[str, Any], passes: bool) -> None:
    seen = Data.model_validate({"file": "result.json", "has": has}).observe(left({"result.json": RESULT}))
    assert seen.passed == passes
    assert seen.expected.startswith("result.json: ")
    assert all(path in seen.observed for path in has)


@pytest.mark.parametrize(
    ("files", "observed"),
    [
        ({}, "there is no such file"),
        ({"result.json": "rows:\n- 20"}, "it is no JSON"),
        ({"result.json": "[" * 200_000}, "it is no JSON"),
        ({"result.json": "9" * 10_000}, "it is no JSON"),
    ],
)
def test_a_file_that_holds_no_values(files: dict[str, str], observed: str) -> None:
    seen = Data.model_validate({"file": "result.json", "has": {"rows": 20}}).observe(left(files))
    assert (seen.passed, seen.observed) == (False, observed)


@pytest.mark.parametrize(
    ("run", "prints", "passes"),
    [
        ('python -c "print(6 * 7)"', "^42$", True),
        ('python -c "print(6 * 7)"', None, True),
        ('python -c "print(6 * 7)"', "43", False),
        ("python -c \"raise SystemExit('42')\"", "42", False),
        ("python here.py", "here", True),
        ("python missing.py", None, False),
        ("irsim --version", "irsim", True),
    ],
)
def test_commands_run_in_the_folder(run: str, prints: str | None, passes: bool, tmp_path: Path) -> None:
    (tmp_path / "here.py").write_text("print(__file__)", encoding="utf-8")
    seen = Command(run=run, prints=prints).observe(left({}, folder=tmp_path))
    assert seen.passed == passes, seen.observed
    assert "exit code" in seen.observed
    assert not Command(run=run, prints=prints).observe(left({})).passed


def test_a_command_that_does_not_end_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("irsim_evals.grader.predicates.files._SECONDS", 0.5)
    seen = Command(run='python -c "while True: pass"').observe(left({}, folder=tmp_path))
    assert (seen.passed, seen.observed) == (False, "it takes more than 0.5 s")


def test_a_file_beside_the_scenario_is_compared_by_its_name() -> None:
    given = {"yard.yaml": "world: {width: 9}\n"}
    same = Edits(base="yard.yaml", file="yard.yaml", same=True)
    assert same.observe(left({**given, "mine.yaml": "world: {width: 4}\n"}, given)).passed
    assert not same.observe(left({"yard.yaml": "world: {width: 8}\n"}, given)).passed
    assert not same.observe(left({"mine.yaml": "world: {width: 9}\n"}, given)).passed
