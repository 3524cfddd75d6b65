"""``irsim validate``."""

from __future__ import annotations

import json
from pathlib import Path

import irsim as package
from tests.cli.conftest import ROOM, Run, parsed


def test_says_what_a_valid_file_holds(irsim: Run, room: Path) -> None:
    result = irsim("validate", "room.yaml")
    assert result.exit_code == 0
    assert "room.yaml: valid: 1 robot" in result.stdout


def test_shows_every_problem_with_its_line(irsim: Run, room: Path) -> None:
    room.write_text(ROOM.replace("dash", "dahs").replace("radius: 0.3", "radius: -1"), encoding="utf-8")
    result = irsim("validate", "room.yaml")
    assert result.exit_code == 2
    assert "room.yaml:4:" in result.stdout
    assert "room.yaml:7:" in result.stdout
    assert "behavior: {name: dahs}" in result.stdout
    assert "dash" in result.stdout


def test_json_is_the_report_of_the_python_function(irsim: Run, room: Path) -> None:
    room.write_text(ROOM.replace("dash", "dahs"), encoding="utf-8")
    result = irsim("validate", "room.yaml", "--json")
    assert result.exit_code == 2
    assert parsed(result) == package.validate("room.yaml").model_dump(mode="json")


def test_several_files_give_one_json_line_each(irsim: Run, room: Path, crash: Path) -> None:
    lines = irsim("validate", "room.yaml", "crash.yaml", "--json").stdout.splitlines()
    assert [json.loads(line)["file"] for line in lines] == ["room.yaml", "crash.yaml"]


def test_one_bad_file_among_good_ones_decides_the_exit_code(irsim: Run, room: Path, crash: Path) -> None:
    crash.write_text("robto: {}\n", encoding="utf-8")
    result = irsim("validate", "crash.yaml", "room.yaml")
    assert result.exit_code == 2
    assert "room.yaml: valid" in result.stdout


def test_reads_standard_input(irsim: Run) -> None:
    assert irsim("validate", "-", input=ROOM).exit_code == 0
    assert irsim("validate", "-", input="robot: 3").exit_code == 2


def test_lenient_only_warns_where_ir_sim_carries_on(irsim: Run, room: Path) -> None:
    room.write_text(ROOM.replace("height: 6", "heigth: 6"), encoding="utf-8")
    assert irsim("validate", "room.yaml").exit_code == 2
    lenient = irsim("validate", "room.yaml", "--lenient")
    assert lenient.exit_code == 0
    assert "unknown-key" in lenient.stdout


def test_limits_can_be_raised(irsim: Run, room: Path) -> None:
    room.write_text(ROOM.replace("  - kin", "  - number: 20\n    kin"), encoding="utf-8")
    assert irsim("validate", "room.yaml", "--max-objects", "10").exit_code == 2
    assert irsim("validate", "room.yaml", "--max-objects", "30").exit_code == 0


def test_fix_mends_the_file_in_place(irsim: Run, room: Path) -> None:
    room.write_text(ROOM.replace("behavior", "behaviour") + "# the end\n", encoding="utf-8")
    result = irsim("validate", "room.yaml", "--fix")
    assert result.exit_code == 0, result.stdout
    assert "renamed 'behaviour' to 'behavior'" in result.stdout
    assert room.read_text(encoding="utf-8") == ROOM + "# the end\n"
    assert "fixed" not in irsim("validate", "room.yaml", "--fix").stdout


def test_fix_says_which_repair_would_lose_comments(irsim: Run, room: Path) -> None:
    goal = next(line for line in ROOM.splitlines() if "goal:" in line)
    text = ROOM.replace(goal, "    goal:\n      x: 9  # by the door\n      y: 5")
    room.write_text(text, encoding="utf-8")
    result = irsim("validate", "room.yaml", "--fix", "--json")
    assert result.exit_code == 2
    assert room.read_text(encoding="utf-8") == text
    assert [finding["fix"] for finding in parsed(result)["findings"] if finding["severity"] == "error"] == [
        "write [9, 5] (by hand: --fix leaves it, as the comments there would be lost)"
    ]


def test_fix_leaves_a_file_alone_that_it_cannot_mend(irsim: Run, room: Path) -> None:
    text = ROOM.replace("dash", "no-such-thing")
    room.write_text(text, encoding="utf-8")
    assert irsim("validate", "room.yaml", "--fix").exit_code == 2
    assert room.read_text(encoding="utf-8") == text


def test_simulate_says_what_happens(irsim: Run, room: Path) -> None:
    result = irsim("validate", "room.yaml", "--simulate")
    assert result.exit_code == 0
    assert "1 of 1 robots arrived" in result.stdout
    tried = parsed(irsim("validate", "room.yaml", "--simulate", "--json"))["dry_run"]
    assert tried == package.validate("room.yaml", simulate=True).model_dump(mode="json")["dry_run"]


def test_diff_lists_changes_and_refuses_those_not_asked_for(irsim: Run, room: Path) -> None:
    Path("other.yaml").write_text(ROOM.replace("dash", "rvo"), encoding="utf-8")
    result = irsim("diff", "room.yaml", "other.yaml")
    assert result.exit_code == 0
    assert "behavior.name" in result.stdout
    assert irsim("diff", "room.yaml", "other.yaml", "--only", "robot[0].behavior").exit_code == 0
    assert irsim("diff", "room.yaml", "other.yaml", "--only", "world").exit_code == 1
    found = parsed(irsim("diff", "room.yaml", "other.yaml", "--json"))
    assert found == package.diff("room.yaml", "other.yaml").model_dump(mode="json")
