"""The worked examples: valid, run to what they state, and an edit that touches only what was asked."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
import yaml

import irsim
from irsim.bundled import templates
from tests.skills.conftest import EXAMPLES, ROOT, SKILL, commands, execute, read

RESULT = re.compile(r"`irsim run scenario\.yaml --seed (\d+)` ends in \*\*(\w+)\*\* after ([\d.]+) s")
ASSUMED = re.compile(r"^- `([^`]+)` = (.+?): ", re.MULTILINE)
each = pytest.mark.parametrize("folder", EXAMPLES, ids=lambda path: path.name)


def at(data: object, path: str) -> object:
    """The value at a path such as ``robot[0].vel_max[1]``."""
    for word in re.findall(r"[^.\[\]]+", path):
        data = data[int(word)] if isinstance(data, list) else data[word]  # type: ignore[index]
    return data


def test_there_is_one_of_each_kind() -> None:
    assert {folder.name for folder in EXAMPLES} == {"loading-dock", "hallway", "patrol-edit", "cafe", "corridor-shift"}


@each
def test_it_is_valid_without_warnings(folder: Path) -> None:
    for path in folder.glob("*.yaml"):
        report = irsim.validate(path)
        assert [finding.code for finding in report.findings if finding.severity != "hint"] == []


@each
def test_it_ends_as_stated_and_the_reply_says_the_same(folder: Path) -> None:
    [(seed, outcome, seconds)] = RESULT.findall(read(folder, "elements.md"))
    result = irsim.run(folder / "scenario.yaml", seed=int(seed))
    assert result.outcome == outcome
    assert result.sim_time == pytest.approx(float(seconds), abs=0.15)
    assert f"run with seed {seed}: {outcome} after {seconds} s" in read(folder, "reply.md")


@pytest.mark.parametrize(
    "folder",
    [*EXAMPLES, *(ROOT / "skills" / "irsim-runner" / "examples" / name for name in ("give-way", "scan-data"))],
    ids=lambda path: path.name,
)
def test_the_assumptions_in_the_reply_are_those_of_the_file(folder: Path) -> None:
    data = yaml.safe_load((folder / "scenario.yaml").read_text(encoding="utf-8"))
    assumed = ASSUMED.findall((folder / "reply.md").read_text(encoding="utf-8"))
    assert assumed
    for path, value in assumed:
        assert at(data, path) == yaml.safe_load(value), path


def test_the_template_is_filled_and_edited_as_told(tmp_path: Path) -> None:
    folder = SKILL / "examples" / "hallway"
    [words] = commands(folder)
    execute(words, tmp_path)
    filled = tmp_path / words[words.index("-o") + 1]
    output = execute(["irsim", "diff", str(filled), str(folder / "scenario.yaml"), "--json"], tmp_path)
    [edited] = re.findall(r"nothing else: (.*?) and the comment", read(folder, "elements.md"))
    assert {item["path"] for item in json.loads(output)["keys"]} == set(re.findall(r"`([^`]+)`", edited))
    assert words[2] in templates.names()


def test_the_edit_touches_only_what_was_asked() -> None:
    folder = SKILL / "examples" / "patrol-edit"
    [words] = commands(folder)
    output = json.loads(execute([*words, "--json"], folder))
    assert {item["path"] for item in output["keys"]} == {
        f"robot[0].{key}" for key in ("vel_max", "vel_min", "waypoints")
    }
    assert {item["object"] for item in output["world"]} == {"guard"}
    assert output["comments_lost"] == []
    assert output["lines_removed"] == output["lines_added"] == 3
