"""The worked examples and the script of ``irsim-scenario``: what they state, and whether to look at a file again."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path
from typing import Any

import pytest
import yaml

import irsim
from irsim.bundled import templates
from tests.skills.conftest import EXAMPLES, ROOT, SKILL, commands, execute, read, script, spans
from tests.skills.test_skill import SKELETON

RESULT = re.compile(r"`irsim run scenario\.yaml --seed (\d+)` ends in \*\*(\w+)\*\* after ([\d.]+) s")
ASSUMED = re.compile(r"^- `([^`]+)` = (.+?): ", re.MULTILINE)
CHECK = SKILL / "scripts" / "check.py"
EXAMPLE_OF_EDIT = SKILL / "examples" / "patrol-edit"
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
    [words] = commands(EXAMPLE_OF_EDIT)
    output = json.loads(execute([*words, "--json"], EXAMPLE_OF_EDIT))
    assert {item["path"] for item in output["keys"]} == {
        f"robot[0].{key}" for key in ("vel_max", "vel_min", "waypoints")
    }
    assert {item["object"] for item in output["world"]} == {"guard"}
    assert output["comments_lost"] == []
    assert output["lines_removed"] == output["lines_added"] == 3


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "hall.yaml").write_text(SKELETON, encoding="utf-8")
    return tmp_path


def check(folder: Path, *words: str) -> tuple[int, dict[str, Any]]:
    return script(CHECK, *words, folder=folder)


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
        EXAMPLE_OF_EDIT, "scenario.yaml", "--base", "before.yaml", "--picture", str(tmp_path / "a.png"), "--steps", "40"
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
