"""The evals of the skills: well formed, an answer can meet them and none does not, triggers are balanced."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
import yaml

from evals.skills.assertions import evals_of, form_of, passes
from tests.evals.conftest import EVALS, ROOT, SKILLS
from tests.warm import warm

ANSWERS: dict[str, dict[str, dict[str, Any]]] = yaml.safe_load(
    (Path(__file__).parent / "answers.yaml").read_text(encoding="utf-8")
)
each = pytest.mark.parametrize("skill", SKILLS)


def triggers(skill: str) -> list[dict[str, Any]]:
    told = json.loads((EVALS / "skills" / skill / "triggers.json").read_text(encoding="utf-8"))
    assert told["skill_name"] == skill
    found: list[dict[str, Any]] = told["queries"]
    return found


@each
def test_evals_are_well_formed(skill: str) -> None:
    folder = EVALS / "skills" / skill
    told = json.loads((folder / "evals.json").read_text(encoding="utf-8"))
    assert (set(told), told["skill_name"]) == ({"skill_name", "evals"}, skill)
    assert len(told["evals"]) >= 5
    assert len({item["id"] for item in told["evals"]}) == len(told["evals"])
    for item in told["evals"]:
        assert set(item) == {"id", "prompt", "expected_output", "files", "assertions"}
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", item["id"])
        assert len(item["assertions"]) >= 2
        assert all(form_of(assertion) for assertion in item["assertions"]), item["id"]
        assert all((folder / name).is_file() for name in item["files"])
    used = {name for item in told["evals"] for name in item["files"]}
    assert {f"files/{path.name}" for path in folder.glob("files/*")} == used
    assert not used & {path.name for path in ROOT.glob("skills/*/examples/*")}


@each
def test_an_empty_folder_and_a_shrug_do_not_pass(skill: str, tmp_path: Path) -> None:
    for item in evals_of(skill):
        plain = [assertion for assertion in item["assertions"] if not re.match(r"`\w+ ", assertion)]
        assert not all(passes(assertion, tmp_path, "Done.")[0] for assertion in plain), item["id"]


def test_there_is_an_answer_to_each_but_one() -> None:
    known = {(skill, name) for skill, answers in ANSWERS.items() for name in answers}
    asked = {(skill, item["id"]) for skill in SKILLS for item in evals_of(skill)}
    assert asked - known == {("irsim-dev", "ellipse")}  # which is a change of the whole tree
    assert known <= asked


def runs_programs(skill: str, name: str) -> bool:
    [item] = [item for item in evals_of(skill) if item["id"] == name]
    return "run" in ANSWERS[skill][name] or any(re.match(r"`\w+ ", assertion) for assertion in item["assertions"])


@pytest.mark.parametrize(
    ("skill", "name"),
    [
        pytest.param(skill, name, id=name, marks=[pytest.mark.slow] if runs_programs(skill, name) else [])
        for skill, answers in ANSWERS.items()
        for name in answers
    ],
)
def test_the_assertions_can_be_met(skill: str, name: str, tmp_path: Path) -> None:
    [item] = [item for item in evals_of(skill) if item["id"] == name]
    answer, given = ANSWERS[skill][name], EVALS / "skills" / skill / "files"
    for path in item["files"]:
        shutil.copy(EVALS / "skills" / skill / path, tmp_path)
    for path, text in answer.get("files", {}).items():
        (tmp_path / path).write_text(text, encoding="utf-8")
    if "replace" in answer:
        text = (given / answer["given"]).read_text(encoding="utf-8")
        for old, new in answer["replace"].items():
            text = text.replace(old, new)
        (tmp_path / answer["given"]).write_text(text, encoding="utf-8")
    for line in answer.get("run", []):
        command, _, target = line.partition(" > ")
        words = shlex.split(command)
        module = words[1:] if words[0] == "python" else ["-m", *words]
        started = warm([sys.executable, *module])
        done = subprocess.run(started, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        if target:
            (tmp_path / target).write_text(done.stdout, encoding="utf-8")
    for assertion in item["assertions"]:
        assert passes(assertion, tmp_path, answer.get("reply", ""), given) == (True, ""), assertion


@pytest.mark.parametrize(
    ("change", "fails"),
    [
        (("range_max: 4", "range_max: 5"), "`lobby.yaml` holds `robot[0].sensors[0].range_max` = 4"),
        (("radius: 0.35", "radius: 0.3"), "`lobby.yaml` differs from the given one only in "),
        (("   (keep this line)", ""), ""),
        (("# forward", ""), "`lobby.yaml` keeps the comments of the given one"),
        (("vel_max: ", "velmax: "), "`lobby.yaml` is valid"),
        (("[7, 7, 0]", "[7, 4.5, 0]"), "`lobby.yaml` ends in success"),
    ],
)
def test_a_wrong_edit_is_seen(tmp_path: Path, change: tuple[str, str], fails: str) -> None:
    given = EVALS / "skills" / "irsim-scenario" / "files"
    text = (given / "lobby.yaml").read_text(encoding="utf-8")
    text = text.replace("range_max: 6", "range_max: 4").replace("number: 121", "number: 61")
    assert change[0] in text
    (tmp_path / "lobby.yaml").write_text(text.replace(*change), encoding="utf-8")
    [item] = [item for item in evals_of("irsim-scenario") if item["id"] == "shorter-sight"]
    failed = [line for line in item["assertions"] if not passes(line, tmp_path, "", given)[0]]
    assert any(line.startswith(fails) for line in failed) if fails else failed == []


def test_an_answer_is_graded_by_one_command(tmp_path: Path) -> None:
    reply = tmp_path / "reply.txt"
    reply.write_text(ANSWERS["irsim-scenario"]["sardines"]["reply"], encoding="utf-8")
    command = [sys.executable, "-m", "evals.skills.assertions", "irsim-scenario", "sardines", str(tmp_path)]
    for words, code, passed in (([], 1, 0), (["--reply", str(reply)], 0, 3)):
        done = subprocess.run(warm([*command, *words]), cwd=ROOT, capture_output=True, text=True, check=False)
        assert (done.returncode, json.loads(done.stdout)["passed"]) == (code, passed), done.stderr


@each
def test_triggers_are_balanced(skill: str) -> None:
    queries = triggers(skill)
    assert len({item["query"] for item in queries}) == len(queries) == 20
    assert all(set(item) == {"query", "should_trigger", "split"} for item in queries)
    assert 8 <= sum(not item["should_trigger"] for item in queries) <= 10
    split = Counter(item["split"] for item in queries)
    assert split == {"train": 12, "validation": 8}
    for part in split:
        wanted = [item["should_trigger"] for item in queries if item["split"] == part]
        assert 0.4 <= sum(wanted) / len(wanted) <= 0.7, part


def test_a_query_leads_to_one_skill_at_most() -> None:
    wanted = Counter(item["query"] for skill in SKILLS for item in triggers(skill) if item["should_trigger"])
    assert max(wanted.values()) == 1
