"""The grader sees everything that lies in a folder, opens what it can, and never follows or trusts it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

from irsim_evals.cases.store import Instance
from irsim_evals.grader.artefact import Answer, from_folder
from irsim_evals.grader.grade import grade
from irsim_evals.grader.limited import grade_folder
from tests.evals.conftest import RIGHT, failed, made_up

PNG = b"\x89PNG\r\n\x1a\n\0\0"
MAP = "world: {width: 12, height: 8, obstacle_map: maps/level2.png}\n"
ROBOT = "robot: {kinematics: {name: diff}, state: [2, 4, 0], goal: [9, 4, 0], behavior: {name: dash}}\n"


def alone(pattern: str = "*", **keys: Any) -> Instance:
    """A case in whose folder nothing but the scenario may lie."""
    return made_up(
        {"id": "robot", "count": {"of": "robots", "number": 1}},
        {"id": "alone", "files": {"pattern": pattern, "number": 1, **keys}},
    )


def left(folder: Path, name: str, content: bytes = b"x") -> None:
    """Leave a right answer and a file besides."""
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content)
    (folder / "scenario.yaml").write_text(RIGHT, encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("config", b"Host *"),
        (".ssh/config", b"Host *"),
        ("maps/level2.png", PNG),
        ("core", b"\x7fELF\0\0"),
        ("notes.docx", b"PK\3\4\0"),
        ("notes", "caf\xe9".encode("latin-1")),
        ("__pycache__/level2.png", PNG),
        (".git/config", b"[core]"),
        ("deep/er/prompt.md", b"x"),
        ("large.txt", b"x" * 2_000_001),
        ("calls.jsonl.bak", b"{}"),
    ],
)
def test_whatever_lies_beside_a_scenario_is_seen(name: str, content: bytes, tmp_path: Path) -> None:
    left(tmp_path, name, content)
    verdict = grade(alone(), from_folder(tmp_path))
    [outcome] = verdict.failed()
    assert outcome.assertion == "alone"
    assert name in outcome.observed
    assert grade(alone("*.yaml"), from_folder(tmp_path)).strict


def test_what_irsim_and_the_user_put_there_is_not_the_agents(tmp_path: Path) -> None:
    for name in ("prompt.md", "prompt-2.md", "calls.jsonl", "log.jsonl", "reply.md"):
        left(tmp_path, name)
    assert grade(alone(), from_folder(tmp_path)).strict


@pytest.mark.skipif(os.name == "nt", reason="makes links and a named pipe")
def test_links_pipes_and_empty_folders_are_named_and_not_opened(tmp_path: Path) -> None:
    left(tmp_path, "notes.md")
    (tmp_path / "link").symlink_to("/etc/passwd")
    (tmp_path / "up").symlink_to("..", target_is_directory=True)
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "empty").mkdir()
    answer = from_folder(tmp_path)
    assert answer.others == {"link": "a link", "up": "a link", "pipe": "no ordinary file", "empty/": "an empty folder"}
    assert set(answer.files) == {"notes.md", "scenario.yaml"}
    assert failed(grade(alone(), answer)) == ["alone"]


def test_many_and_large_files_are_named_with_size_and_digest(tmp_path: Path) -> None:
    left(tmp_path, "a/notes.md")
    for number in range(300):
        (tmp_path / ".cache" / f"{number}").parent.mkdir(exist_ok=True)
        (tmp_path / ".cache" / f"{number}").write_bytes(b"x")
    answer = from_folder(tmp_path)
    assert (len(answer.files), len(answer.others)) == (200, 102)
    assert {"scenario.yaml", "a/notes.md"} < set(answer.files)  # what is not hidden is opened first
    assert set(answer.others.values()) == {"1 bytes, sha256 2d711642b726b044"}


@pytest.mark.parametrize("keys", [{"contain": ["x"]}, {"lack": ["y"]}])
def test_of_a_file_that_was_not_opened_nothing_is_known(keys: dict[str, Any], tmp_path: Path) -> None:
    left(tmp_path, "large.txt", b"x" * 2_000_001)
    assert failed(grade(alone("large.txt", **keys), from_folder(tmp_path))) == ["alone"]


@pytest.mark.parametrize(
    ("name", "content"),
    [(".run.py", b"print()"), ("run", b"#!/usr/bin/env python3\nprint()"), ("run.py", b"#" * 2_000_001)],
)
def test_a_program_is_seen_whatever_it_is_called(name: str, content: bytes, tmp_path: Path) -> None:
    left(tmp_path, name, content)
    verdict = grade(made_up({"id": "robot", "count": {"of": "robots", "number": 1}}), from_folder(tmp_path))
    assert failed(verdict) == ["only-yaml"]


def test_a_hidden_scenario_is_no_rival(tmp_path: Path) -> None:
    left(tmp_path, ".backup/other.yaml", RIGHT.replace("14", "15").encode())
    (tmp_path / "scenario.yaml").rename(tmp_path / "hall.yaml")
    assert grade(made_up({"id": "robot", "count": {"of": "robots", "number": 1}}), from_folder(tmp_path)).strict


MISSING = made_up({"id": "size", "world": {"width": 12, "map_file": "maps/level2.png"}}, missing=["maps/level2.png"])


def test_a_scenario_may_name_a_map_that_only_the_user_has(tmp_path: Path) -> None:
    (tmp_path / "scenario.yaml").write_text(MAP + ROBOT, encoding="utf-8")
    verdict = grade_folder(MISSING, tmp_path)
    assert failed(verdict) == []
    assert verdict.strict


@pytest.mark.parametrize("name", ["maps/level2.png", "scenario.yaml"])
def test_a_map_that_only_the_user_has_is_neither_invented_nor_replaced(name: str, tmp_path: Path) -> None:
    (tmp_path / "maps").mkdir()
    (tmp_path / "scenario.yaml").write_text(MAP + ROBOT, encoding="utf-8")
    (tmp_path / name).write_bytes(PNG if name != "scenario.yaml" else (MAP.replace("level2", "x") + ROBOT).encode())
    assert not grade_folder(MISSING, tmp_path).strict


def test_a_map_that_nobody_has_is_still_an_error() -> None:
    case = made_up({"id": "size", "world": {"width": 12}})
    assert failed(grade(case, Answer("answer", {"scenario.yaml": MAP + ROBOT}))) == ["valid", "size"]


@pytest.mark.parametrize("name", ["level2.txt", "../level2.png", "/level2.png"])
def test_a_missing_map_is_a_picture_below_the_folder(name: str) -> None:
    with pytest.raises(ValueError, match="missing"):
        made_up({"id": "size", "world": {"width": 12}}, missing=[name])


def test_many_pictures_in_a_folder_do_not_hide_the_scenario(tmp_path: Path) -> None:
    (tmp_path / "frames").mkdir()
    for number in range(230):
        (tmp_path / "frames" / f"{number:03}.png").write_bytes(b"\x89PNG")
    (tmp_path / "scenario.yaml").write_text("world: {width: 3, height: 3}\n", encoding="utf-8")
    (tmp_path / "reply.md").write_text("Done.", encoding="utf-8")
    answer = from_folder(tmp_path)
    assert (list(answer.files), answer.reply) == (["scenario.yaml"], "Done.")


def test_runs_that_the_tools_have_recorded_are_not_files_of_the_answer(tmp_path: Path) -> None:
    for name in ("runs/before-1", "runs/made-up", "jobs/one"):
        (tmp_path / ".irsim" / name).mkdir(parents=True)
        (tmp_path / ".irsim" / name / "scenario.yaml").write_text("world: {}\n", encoding="utf-8")
    for name in ("runs/before-1", "jobs/one"):
        (tmp_path / ".irsim" / name / "run.json").write_text("{}", encoding="utf-8")
    (tmp_path / "scenario.yaml").write_text("world: {}\n", encoding="utf-8")
    assert list(from_folder(tmp_path).files) == ["scenario.yaml", ".irsim/runs/made-up/scenario.yaml"]
