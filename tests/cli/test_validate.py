"""``irsim validate``."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import irsim as package
from tests.cli.conftest import ROOM, Run, parsed


def test_says_what_a_valid_file_holds(irsim: Run, room: Path) -> None:
    result = irsim("validate", "room.yaml", code=0)
    assert "room.yaml: valid: 1 robot" in result.stdout


def test_shows_every_problem_with_its_line(irsim: Run, room: Path) -> None:
    room.write_text(ROOM.replace("dash", "dahs").replace("radius: 0.3", "radius: -1"), encoding="utf-8")
    result = irsim("validate", "room.yaml", code=2)
    assert "room.yaml:4:" in result.stdout
    assert "room.yaml:7:" in result.stdout
    assert "behavior: {name: dahs}" in result.stdout
    assert "dash" in result.stdout


def test_json_is_the_report_of_the_python_function(irsim: Run, room: Path) -> None:
    room.write_text(ROOM.replace("dash", "dahs"), encoding="utf-8")
    result = irsim("validate", "room.yaml", "--json", code=2)
    assert parsed(result) == package.validate("room.yaml").model_dump(mode="json")


def test_several_files_give_one_json_line_each(irsim: Run, room: Path, crash: Path) -> None:
    lines = irsim("validate", "room.yaml", "crash.yaml", "--json").stdout.splitlines()
    assert [json.loads(line)["file"] for line in lines] == ["room.yaml", "crash.yaml"]


def test_one_bad_file_among_good_ones_decides_the_exit_code(irsim: Run, room: Path, crash: Path) -> None:
    crash.write_text("robto: {}\n", encoding="utf-8")
    result = irsim("validate", "crash.yaml", "room.yaml", code=2)
    assert "room.yaml: valid" in result.stdout


def test_reads_standard_input(irsim: Run) -> None:
    assert irsim("validate", "-", input=ROOM).exit_code == 0
    assert irsim("validate", "-", input="robot: 3").exit_code == 2


def test_lenient_only_warns_where_ir_sim_carries_on(irsim: Run, room: Path) -> None:
    room.write_text(ROOM.replace("height: 6", "heigth: 6"), encoding="utf-8")
    assert irsim("validate", "room.yaml").exit_code == 2
    lenient = irsim("validate", "room.yaml", "--lenient", code=0)
    assert "unknown-key" in lenient.stdout


def test_limits_can_be_raised(irsim: Run, room: Path) -> None:
    room.write_text(ROOM.replace("  - kin", "  - number: 20\n    kin"), encoding="utf-8")
    assert irsim("validate", "room.yaml", "--max-objects", "10").exit_code == 2
    assert irsim("validate", "room.yaml", "--max-objects", "30").exit_code == 0


def test_fix_mends_the_file_in_place(irsim: Run, room: Path) -> None:
    room.write_text(ROOM.replace("behavior", "behaviour") + "# the end\n", encoding="utf-8")
    result = irsim("validate", "room.yaml", "--fix", code=0)
    assert "renamed 'behaviour' to 'behavior'" in result.stdout
    assert room.read_text(encoding="utf-8") == ROOM + "# the end\n"
    assert "fixed" not in irsim("validate", "room.yaml", "--fix").stdout


def test_fix_of_standard_input_is_a_filter(irsim: Run, room: Path) -> None:
    crooked = ROOM.replace("behavior", "behaviour") + "# the end\n"
    result = irsim("validate", "-", "--fix", input=crooked)
    assert (result.exit_code, result.stdout) == (0, ROOM + "# the end\n")
    assert "renamed 'behaviour' to 'behavior'" in result.stderr
    assert "valid: 1 robot" in result.stderr
    assert irsim("validate", "-", "--fix", input=ROOM).stdout == ROOM  # nothing to do
    hopeless = ROOM.replace("dash", "no-such-thing")
    result = irsim("validate", "-", "--fix", input=hopeless)
    assert (result.exit_code, result.stdout) == (2, hopeless)
    assert "unknown-behavior" in result.stderr


@pytest.mark.parametrize("more", ["--json", "room.yaml"])
def test_fix_of_standard_input_prints_nothing_else(irsim: Run, room: Path, more: str) -> None:
    before = room.read_text(encoding="utf-8")
    result = irsim("validate", "-", "--fix", more, input=ROOM, code=2)
    assert "--fix with - prints the repaired text" in " ".join(result.stderr.split())
    assert room.read_text(encoding="utf-8") == before


def test_fix_says_which_repair_would_lose_comments(irsim: Run, room: Path) -> None:
    goal = next(line for line in ROOM.splitlines() if "goal:" in line)
    text = ROOM.replace(goal, "    goal:\n      x: 9  # by the door\n      y: 5")
    room.write_text(text, encoding="utf-8")
    result = irsim("validate", "room.yaml", "--fix", "--json", code=2)
    assert room.read_text(encoding="utf-8") == text
    assert [finding["fix"] for finding in parsed(result)["findings"] if finding["severity"] == "error"] == [
        "write [9, 5] (by hand: --fix does not change it, because comments there would be lost)"
    ]


def test_fix_leaves_a_file_alone_that_it_cannot_mend(irsim: Run, room: Path) -> None:
    text = ROOM.replace("dash", "no-such-thing")
    room.write_text(text, encoding="utf-8")
    assert irsim("validate", "room.yaml", "--fix").exit_code == 2
    assert room.read_text(encoding="utf-8") == text


def test_simulate_says_what_happens(irsim: Run, room: Path) -> None:
    result = irsim("validate", "room.yaml", "--simulate", code=0)
    assert "1 of 1 robots arrived" in result.stdout
    tried = parsed(irsim("validate", "room.yaml", "--simulate", "--json"))["dry_run"]
    assert tried == package.validate("room.yaml", simulate=True).model_dump(mode="json")["dry_run"]


def test_diff_lists_changes_and_refuses_those_not_asked_for(irsim: Run, room: Path) -> None:
    Path("other.yaml").write_text(ROOM.replace("dash", "rvo"), encoding="utf-8")
    result = irsim("diff", "room.yaml", "other.yaml", code=0)
    assert "behavior.name" in result.stdout
    assert irsim("diff", "room.yaml", "other.yaml", "--only", "robot[0].behavior").exit_code == 0
    assert "in motion" not in result.stdout
    assert "in motion" in irsim("diff", "room.yaml", "other.yaml", "--run", code=0).stdout
    assert irsim("diff", "room.yaml", "other.yaml", "--only", "world").exit_code == 1
    printed = parsed(irsim("diff", "room.yaml", "other.yaml", "--json"))
    assert printed == package.diff("room.yaml", "other.yaml").model_dump(mode="json")


COMMENTED = """\
world: {width: 10, height: 10}
# the one that carries things
robot:
  - kinematics: {name: diff}
    state: [1, 1, 0]
    goal: [9, 9]  # by the door
    behavior: {name: dash}
    # not faster than that
  # the pillar in the hall
obstacle:
  - shape: {name: circle, radius: 1}
    # not moved since May
    state: [5, 2]  # the middle of the hall
"""


@pytest.mark.parametrize(
    ("before", "after", "code"),
    [
        ("# by the door", "# by the back door", 0),
        ("# not faster than that", "# not faster than this", 0),
        ("# the one that carries", "# The one that carries", 1),
        ("# the pillar in", "# the pillars in", 1),
        ("# not moved since May", "# not moved since June", 1),
        ("# the middle of", "# the very middle of", 1),
        ("  # by the door", "", 1),
        ("[9, 9]", "[9, 8]", 0),
        ("[5, 2]", "[5, 3]", 1),
    ],
)
def test_changed_comments_of_what_may_not_differ_count(
    irsim: Run, tmp_path: Path, before: str, after: str, code: int
) -> None:
    a, b = tmp_path / "a.yaml", tmp_path / "b.yaml"
    a.write_text(COMMENTED, encoding="utf-8")
    assert before in COMMENTED
    b.write_text(COMMENTED.replace(before, after), encoding="utf-8")
    assert irsim("diff", str(a), str(b), "--only", "robot[0]").exit_code == code
    assert irsim("diff", str(a), str(b), "--json").exit_code == 0


def test_comments_of_a_single_robot_are_those_of_the_first(irsim: Run, tmp_path: Path) -> None:
    a, b = tmp_path / "a.yaml", tmp_path / "b.yaml"
    single = COMMENTED.replace("  - kin", "    kin")
    a.write_text(single, encoding="utf-8")
    b.write_text(
        single.replace("# the one that", "# The one that").replace("by the door", "by a door"), encoding="utf-8"
    )
    assert irsim("diff", str(a), str(b), "--only", "robot[0]").exit_code == 0
    assert irsim("diff", str(a), str(b), "--only", "obstacle").exit_code == 1


TASK = """
task: crossing
scenario:
  world: {width: 10, height: 10, time_limit: 20}
  robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0], goal: [8, 8]}
observation: [{name: goal}]
reward: [{name: progress, weight: 1}]
"""


def test_options_of_scenarios_leave_tasks_beside_them_alone(irsim: Run, room: Path) -> None:
    Path("task.yaml").write_text(TASK)
    irsim("validate", "task.yaml", code=0)
    result = irsim("validate", "room.yaml", "task.yaml", "--simulate", "--table", code=0)
    assert result.stdout.count("tried") == 1
    assert "task.yaml: valid" in result.stdout
    assert irsim("validate", "task.yaml", "--simulate").exit_code == 2


def test_drawn_places_are_printed_to_the_millimetre(irsim: Run) -> None:
    text = """
world: {width: 12, height: 12}
robot: {number: 2, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, behavior: {name: dash},
  distribution: {name: random, range_low: [1, 1, -3]}}
"""
    Path("a.yaml").write_text(text)
    Path("b.yaml").write_text(text.replace("[1, 1, -3]", "[1.5, 1, -3]"))
    printed = irsim("diff", "a.yaml", "b.yaml").stdout
    assert re.search(r"robot_0 pose  \[[\d., -]+\] -> \[", printed)
    assert not re.search(r"\d\.\d{4}", printed)


def test_places_of_a_missing_file_are_a_list(irsim: Run, room: Path) -> None:
    lines = irsim("validate", "rom.yaml", code=2).stdout.splitlines()
    assert "  no scenario file 'rom.yaml'. Searched:" in lines
    assert f"    {room.parent}" in lines
    assert "  Did you mean 'room.yaml'?" in lines


def test_what_only_a_run_tolerates_names_the_difference(irsim: Run, room: Path) -> None:
    text = room.read_text(encoding="utf-8")
    room.write_text(text.replace("{name: dash}", "{name: dash, vmaxx: 3}"), encoding="utf-8")
    refused = irsim("validate", "room.yaml", code=2).stdout
    assert "1 problem that IR-SIM 2.12 tolerates (irsim describe D4): irsim run warns and goes on" in refused
    assert "tolerates (irsim describe D4): run and render go on" in irsim("run", "room.yaml", code=0).stderr
    assert "an intended difference from IR-SIM 2.12" in irsim("describe", "D4", code=0).stdout
    irsim("run", "room.yaml", "--strict", code=2)
    room.write_text(text.replace("{name: dash}", "{name: dahs}"), encoding="utf-8")  # which a run refuses, too
    assert "describe D4" not in irsim("validate", "room.yaml", code=2).stdout
    irsim("run", "room.yaml", code=2)
