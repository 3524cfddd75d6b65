"""The worked examples: valid, run to what they state, and an edit that touches only what was asked."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

import irsim
from irsim import templates
from tests.skills.conftest import EXAMPLES, SKILL, execute, fences

RESULT = re.compile(r"`irsim run scenario\.yaml --seed (\d+)` ends in \*\*(\w+)\*\* after ([\d.]+) s")
ASSUMED = re.compile(r"^- `([^`]+)` = (.+?): ", re.MULTILINE)
CHANGED = SKILL / "scripts" / "changed.py"
each = pytest.mark.parametrize("folder", EXAMPLES, ids=lambda path: path.name)


def read(folder: Path, name: str) -> str:
    return (folder / name).read_text(encoding="utf-8")


def at(data: object, path: str) -> object:
    """What stands at a path such as ``robot[0].vel_max[1]``."""
    for word in re.findall(r"[^.\[\]]+", path):
        data = data[int(word)] if isinstance(data, list) else data[word]  # type: ignore[index]
    return data


def test_there_is_one_of_each_kind() -> None:
    assert {folder.name for folder in EXAMPLES} == {"loading-dock", "hallway", "patrol-edit", "cafe"}


@each
def test_it_is_valid_without_warnings(folder: Path) -> None:
    for path in folder.glob("*.yaml"):
        report = irsim.validate(path)
        assert [finding.code for finding in report.findings if finding.severity != "hint"] == []


@each
def test_it_ends_as_stated_and_the_reply_says_the_same(folder: Path) -> None:
    [(seed, outcome, seconds)] = RESULT.findall(" ".join(read(folder, "elements.md").split()))
    result = irsim.run(folder / "scenario.yaml", seed=int(seed))
    assert result.outcome == outcome
    assert result.sim_time == pytest.approx(float(seconds), abs=0.15)
    assert f"run with seed {seed}: {outcome} after {seconds} s" in " ".join(read(folder, "reply.md").split())


@each
def test_the_assumptions_in_the_reply_are_those_of_the_file(folder: Path) -> None:
    data = yaml.safe_load(read(folder, "scenario.yaml"))
    assumed = ASSUMED.findall(read(folder, "reply.md"))
    assert assumed
    for path, value in assumed:
        assert at(data, path) == yaml.safe_load(value), path


@each
def test_the_picture_is_small(folder: Path) -> None:
    png = (folder / "snapshot.png").read_bytes()
    assert png.startswith(b"\x89PNG")
    assert max(int.from_bytes(png[16:20], "big"), int.from_bytes(png[20:24], "big")) <= 480
    assert len(png) < 20_000


def test_the_template_is_filled_and_edited_as_told(tmp_path: Path) -> None:
    folder = SKILL / "examples" / "hallway"
    text = read(folder, "elements.md")
    [command] = fences(text, "bash")
    words = shlex.split(command)
    execute(words, tmp_path)
    filled = tmp_path / words[words.index("-o") + 1]
    output = execute(["python", str(CHANGED), str(filled), str(folder / "scenario.yaml")], tmp_path)
    [edited] = re.findall(r"nothing else: (.*?) and the comment", text, re.DOTALL)
    assert {item["path"] for item in json.loads(output)["changed"]} == set(re.findall(r"`([^`]+)`", edited))
    assert words[2] in templates.names()


def test_the_edit_touches_only_what_was_asked() -> None:
    folder = SKILL / "examples" / "patrol-edit"
    [command] = fences(read(folder, "elements.md"), "bash")
    output = json.loads(execute(shlex.split(command), folder))
    assert [item["path"] for item in output["changed"]] == [
        "robot[0].vel_max[0]",
        "robot[0].vel_min[0]",
        "robot[0].waypoints[3][0]",
        "robot[0].waypoints[3][1]",
    ]
    assert output["comments_lost"] == []
    assert output["lines_removed"] == output["lines_added"] == 3


def changed(before: Path, after: Path, *more: str) -> tuple[int, dict[str, object]]:
    command = [sys.executable, str(CHANGED), str(before), str(after), *more]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.returncode, json.loads(done.stdout) if done.stdout else {}


def test_the_script_finds_other_changes_and_lost_comments(tmp_path: Path) -> None:
    before, after = tmp_path / "before.yaml", tmp_path / "after.yaml"
    before.write_text("world: {width: 10, height: 8}  # m\nrobot: {name: '#1', state: [1, 1, 0]}\n", encoding="utf-8")
    after.write_text("world:\n  width: 10\n  height: 9\nrobot: {name: '#1', state: [1, 1, 0], goal: [2, 2]}\n")
    code, found = changed(before, after, "--only", "world.height")
    assert code == 1
    assert found["comments_lost"] == ["# m"]
    assert found["not_asked_for"] == ["robot.goal[0]", "robot.goal[1]"]
    code, found = changed(before, before, "--only", "world")
    assert code == 0
    assert found["changed"] == []


def test_the_script_says_what_it_cannot_read(tmp_path: Path) -> None:
    broken = tmp_path / "broken.yaml"
    broken.write_text("world: [", encoding="utf-8")
    command = [sys.executable, str(CHANGED), str(broken), str(tmp_path / "missing.yaml")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    assert "missing.yaml" in done.stderr
