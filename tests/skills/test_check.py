"""The script of ``irsim-scenario``: one answer about a file, and an exit code that says whether to look at it again."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.skills.conftest import SKILL, execute, spans
from tests.skills.test_skill import SKELETON
from tests.warm import warm

SCRIPT = SKILL / "scripts" / "check.py"
EDIT = SKILL / "examples" / "patrol-edit"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "hall.yaml").write_text(SKELETON, encoding="utf-8")
    return tmp_path


def check(folder: Path, *words: str) -> tuple[int, dict[str, Any]]:
    command = [sys.executable, str(SCRIPT), *words]
    done = subprocess.run(warm(command), cwd=folder, capture_output=True, text=True, check=False)
    assert "Traceback" not in done.stderr
    assert len(done.stdout) < 20_000
    return done.returncode, json.loads(done.stdout) if done.stdout else {"said": done.stderr}


def test_the_command_of_the_skill_works_as_written(folder: Path) -> None:
    guide = (SKILL / "guides" / "commands.md").read_text(encoding="utf-8")
    [command] = [span for span in spans(guide) if span.startswith("python ")]
    (folder / "before.yaml").write_text(SKELETON.replace("width: 12 ", "width: 14 "), encoding="utf-8")
    _, script, *words = shlex.split(command)
    told = json.loads(execute(["python", str(SKILL / script), *words], folder))
    assert told["look_at"] == []
    assert [change["path"] for change in told["changes"]["keys"]] == ["world.width"]
    assert (folder / "start.png").read_bytes().startswith(b"\x89PNG")


def test_a_good_edit_says_what_it_changed_and_where_things_are(tmp_path: Path) -> None:
    code, told = check(
        EDIT, "scenario.yaml", "--base", "before.yaml", "--picture", str(tmp_path / "a.png"), "--steps", "40"
    )
    assert (code, told["valid"], told["look_at"]) == (0, True, [])
    assert told["dry_run"]["arrived"] == ["guard"]
    assert [fact["key"] for fact in told["changes"]["world"]] == ["goals"]  # the limits only repeat their keys
    assert told["picture"]["robots"][0]["pose"] == [6.0, 2.0, 0.0]
    assert told["picture"]["time"] == 4.0


def test_errors_come_with_their_repair_and_no_picture(folder: Path) -> None:
    (folder / "wrong.yaml").write_text(SKELETON.replace("behavior:", "behaviour:"), encoding="utf-8")
    code, told = check(folder, "wrong.yaml", "--picture", "a.png")
    assert (code, told["valid"]) == (1, False)
    assert told["findings"][0]["fix"] == "rename it to 'behavior'"
    assert told["look_at"][0].startswith("error unknown-key at robot[0].behaviour: ")
    assert not (folder / "a.png").exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("[1.5, 4, 0]", "[1.5, 4, 90]"), "hint heading-in-degrees at robot[0].state"),
        (("[6, 6.5, 0]", "[6, 4, 0]"), "tried: "),
        (("    vel_min: [-1.0, -1.5]\n", "    vel_min: [0, 0]\n    vel_max: [0, 0]\n"), "error"),
        (("      # m\n", "\n"), "comments of the base that are gone: 1"),
        (("", ""), "nothing differs from the base"),
    ],
)
def test_what_is_to_be_looked_at(folder: Path, change: tuple[str, str], said: str) -> None:
    (folder / "after.yaml").write_text(SKELETON.replace(*change) if change[0] else SKELETON, encoding="utf-8")
    code, told = check(folder, "after.yaml", "--base", "hall.yaml")
    assert code == (3 if told["valid"] else 1)
    assert any(line.startswith(said) for line in told["look_at"]), told["look_at"]


def test_what_the_base_has_too_is_not_new(folder: Path) -> None:
    touching = SKELETON.replace("[6, 6.5, 0]", "[6, 4, 0]")
    (folder / "before.yaml").write_text(touching, encoding="utf-8")
    (folder / "after.yaml").write_text(touching.replace("width: 12 ", "width: 13 "), encoding="utf-8")
    code, told = check(folder, "after.yaml", "--base", "before.yaml")
    assert code == 3
    assert [line.partition(":")[0] for line in told["look_at"]] == ["tried"]
    assert [finding["in_base"] for finding in told["findings"]] == [True]


@pytest.mark.parametrize("words", [["hall.yaml", "--picture", "a.svg"], ["hall.yaml", "--base", "none.yaml"]])
def test_what_it_cannot_use_it_refuses(folder: Path, words: list[str]) -> None:
    code, told = check(folder, *words)
    assert (code, words[-1] in told["said"]) == (2, True)
