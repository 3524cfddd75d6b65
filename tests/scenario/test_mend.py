"""Repairs: what needs no guessing is mended in the text, the rest is left for the author."""

from __future__ import annotations

from pathlib import Path

import pytest

from irsim.scenario.autofix import repair_text
from irsim.scenario.yaml.comments import comments

BAD = sorted((Path(__file__).parents[1] / "bad").glob("*.yaml"))

FLAWED = """\
# my scene
world:
  widht: 12          # m
  height: 10
  step_time: 1e-1    # s
robot:
  - kinematics: {name: dif}   # two wheels
    shape: {name: circle, radius: 0.3}
    state: [1, 1, 0]
    goal: [[9, 1], [9, 9]]    # route
    behaviour: {name: dash, loop: yes, wander: true}
    vel_max: [1.0, 1.5]
    wheels: 3
    # last
obstacle:
  - number: 2.0
    shape: {name: rectangle, lenght: 1, width: 1}
    distribution: {name: random}
    state: [3, 3, 0]  # ignored
"""

MENDED = """\
# my scene
world:
  width: 12          # m
  height: 10
  step_time: 0.1    # s
robot:
  - kinematics: {name: diff}   # two wheels
    shape: {name: circle, radius: 0.3}
    state: [1, 1, 0]
    waypoints: [[9, 1], [9, 9]]    # route
    behavior: {name: dash, wander: true}
    vel_max: [1.0, 1.5]
    wheels: 3
    # last
obstacle:
  - number: 2
    shape: {name: rectangle, length: 1, width: 1}
    distribution: {name: random}
    # ignored
"""


def test_mends_slips_and_keeps_every_other_character() -> None:
    mended = repair_text(FLAWED)
    assert mended.text == MENDED
    assert [item.code for item in mended.reading.errors] == ["unknown-key"]  # 'wheels': its meaning is unknown
    changes = {repair.change for repair in mended.repairs}
    assert {"renamed 'widht' to 'width'", "wrote 0.1", "wrote diff", "removed 'state'"} <= changes


def test_mending_again_changes_nothing() -> None:
    mended = repair_text(repair_text(FLAWED).text)
    assert (mended.text, mended.repairs) == (MENDED, [])


@pytest.mark.parametrize("path", BAD, ids=lambda path: path.stem)
def test_never_makes_a_file_worse(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    before = repair_text(text, path=str(path))
    assert bool(before.repairs) == (before.text != text)
    repaired = {repair.finding.code for repair in before.repairs}
    again = repair_text(before.text, path=str(path))
    assert again.text == before.text
    assert len(before.reading.errors) <= len(again.reading.errors) or repaired


def test_hints_and_guesses_are_left_alone() -> None:
    text = (
        "world: {width: 10, height: 10}\n"
        "robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0]}\n"  # hint: no behavior
        "obstacle: {shape: {name: polygon, vertices: [[4, 4], [6, 4], [5, 6]]}}\n"  # a warning: where does it stand?
    )
    mended = repair_text(text)
    assert mended.text == text
    assert {"no-behavior", "default-state"} <= {item.code for item in mended.reading.diagnostics}


ROBOT = "state: [1, 5, 0], goal: [9, 5], behavior: {name: dash}"


@pytest.mark.parametrize(
    ("line", "repaired"),
    [
        ("sensors: [{name: lidar2d, angle_range: 180}]", "sensors: [{name: lidar2d, angle_range: 3.141592654}]"),
        ("sensors: [{name: lidar2d, angle_range: 270}]", "sensors: [{name: lidar2d, angle_range: 4.71238898}]"),
        ("sensors: [{name: lidar2d, angle_range: 360}]", "sensors: [{name: lidar2d, angle_range: 6.283185307}]"),
        ("fov: 90, fov_radius: 3", "fov: 1.570796327, fov_radius: 3"),
        ("sensors: [{name: lidar2d, angle_range: 7}]", None),  # its meaning is unknown
        ("sensors: [{name: lidar2d, range: 5, range_max: 6}]", None),  # would be there twice
        ("shape: {type: rectangle, length: 0.6, width: 0.4}", "shape: {name: rectangle, length: 0.6, width: 0.4}"),
        ("shape: {name: circle, diameter: 0.6}", None),
        ("shape: {name: rectangle, width: 0.6, height: 0.4}", None),
    ],
)
def test_values_and_names_that_were_meant(line: str, repaired: str | None) -> None:
    head = "world: {width: 10, height: 10}\nrobot:\n  - {kinematics: {type: diff}, "
    mended = repair_text(f"{head}{ROBOT}, {line}}}\n")
    expected = f"{head}{ROBOT}, {repaired or line}}}\n".replace("{type: diff}", "{name: diff}")
    assert mended.text == expected
    if repaired:
        assert not mended.reading.errors


def test_a_key_is_not_renamed_to_one_that_is_there() -> None:
    text = f"robot:\n  - {{kinematics: {{name: diff}}, {ROBOT}}}\nrobots:\n  - {{kinematics: {{name: omni}}}}\n"
    mended = repair_text(text)
    assert mended.text == text
    (item,) = mended.reading.errors
    assert item.edit is None
    assert item.fix == "the key is called 'robot', which is given here too: keep one of them"
    both = repair_text(f"robot: {{kinematics: {{name: diff}}, start: [1, 5, 0], pose: [2, 5, 0], {ROBOT[18:]}}}\n")
    assert both.text.count("state:") == 1


def test_places_written_as_mappings() -> None:
    text = "robot: {kinematics: {name: diff}, state: {x: 1, y: 5, theta: 0}, goal: {x: 9, y: 5}, waypoints: null}\n"
    mended = repair_text(text)
    assert "state: [1, 5, 0], goal: [9, 5]" in mended.text
    assert "waypoints: [[9, 5]]" in repair_text("robot: {kinematics: {name: diff}, waypoints: [9, 5]}\n").text


def test_lines_below_a_renamed_key_are_their_own() -> None:
    text = "world: {width: 10}\nrobots:\n  - kinematics: {name: diff}\n    position: [1, 5, pi]\n    color: bleu\n"
    mended = repair_text(text)
    assert {(repair.finding.code, repair.finding.line) for repair in mended.repairs} == {
        ("unknown-key", 2),
        ("unknown-key", 4),
        ("wrong-type", 4),
        ("unknown-color", 5),
    }


COMMENTED = """\
world: {width: 10, height: 10}
robot:
  - kinematics: {nme: diff}
    state:
      x: 1  # east
      y: 5  # it's # the middle
      theta: 0
    goal: {x: 9, y: 5}  # there
    behavior: {name: dash}
    sensors:
      name: lidar2d  # in front
      range_max: 5
obstacle:
  - shape:
      name: polygon
      vertices:
        - [4, 6]  # a
        - [6, 8]  # b
        - [6, 6]
        - [4, 8]
    state: [0, 0, 0]
"""


def test_a_repair_that_would_lose_comments_is_left_to_the_author() -> None:
    mended = repair_text(COMMENTED)
    assert mended.text == COMMENTED.replace("nme", "name").replace("{x: 9, y: 5}", "[9, 5]")
    left = {item.path: item.fix or "" for item in mended.reading.errors}
    assert list(left) == [("robot", 0, "state"), ("robot", 0, "sensors"), ("obstacle", 0, "shape", "vertices")]
    assert all(
        fix.endswith("(by hand: --fix does not change it, because comments there would be lost)")
        for fix in left.values()
    )
    assert left["robot", 0, "state"].startswith("write [1, 5, 0]")
    bare = repair_text("\n".join(line.partition("  #")[0] for line in COMMENTED.splitlines()) + "\n")
    assert not bare.reading.errors


def test_goals_of_several_objects_do_not_become_the_way_of_each() -> None:
    text = (
        "world: {width: 10, height: 10}\nrobot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, "
        "behavior: {name: dash}, number: 2, state: [[1, 5, 0], [1, 7, 0]], goal: [[9, 5], [9, 7], [9, 8]]}\n"
    )
    mended = repair_text(text)
    assert mended.text == text
    (item,) = [item for item in mended.reading.diagnostics if item.code == "goal-levels"]
    assert item.fix is not None
    assert item.fix.startswith("goal: [[9, 5], [9, 7]], or number: 3")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a: 1  # b\n# c\n#d\ne: 'f # g'  # h", ["# b", "# c", "#d", "# h"]),
        ("a: it's  # don't\nb: [\"#\", 'it''s #']  # \"c\"", ["# don't", '# "c"']),
        ("a: x#y\n", []),
    ],
)
def test_comments_of_a_text(text: str, expected: list[str]) -> None:
    assert comments(text) == expected


def test_keys_of_follow_written_into_its_local_behavior_move_one_level_up() -> None:
    """Where they have an effect: the robots of the repaired text look at other robots only, and wander."""
    text = (
        "robot:\n"
        "  - kinematics: {name: diff}  # two wheels\n"
        "    shape: {name: circle, radius: 0.3}\n"
        "    number: 2\n"
        "    state: [[1, 5, 0], [9, 5, 0]]\n"
        "    behavior: {name: follow, local: {name: orca, target_roles: robot, timeHorizon: 2, wander: true}}\n"
    )
    mended = repair_text(text)
    assert [repair.finding.code for repair in mended.repairs] == ["ignored-key"]
    assert "behavior: {name: follow, local: {name: orca, timeHorizon: 2}, wander: true, target_roles: robot}" in (
        mended.text
    )
    scenario = mended.reading.scenario
    assert scenario is not None
    assert [(o.wander, o.target_roles) for o in scenario.objects] == [(True, "robot")] * 2
    before = repair_text(text.replace("target_roles: robot, ", "").replace(", wander: true", ""))
    assert "ignored-key" not in [item.code for item in before.reading.diagnostics]


def test_keys_that_stand_in_both_places_go_from_the_inner_one() -> None:
    text = (
        "robot: {kinematics: {name: diff}, shape: {name: circle}, state: [1, 5, 0], goal: [9, 5],\n"
        "  behavior: {name: follow, target_roles: obstacle, local: {name: orca, target_roles: all}}}\n"
        "obstacle: [{shape: {name: circle}, state: [5, 5, 0]}]\n"
    )
    assert "{name: follow, target_roles: obstacle, local: {name: orca}}" in repair_text(text).text
