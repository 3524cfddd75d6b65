"""Edits and repairs of the text: what is asked or needs no guessing changes, every other character stays."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from irsim.diagnostics.diagnostic import Edit
from irsim.scenario.autofix import repair_text
from irsim.scenario.yaml.comments import comments
from irsim.scenario.yaml.edits import apply_edits
from irsim.scenario.yaml.rewrite import rewrite, yaml_flow
from tests.effort import examples

BAD = sorted(Path(__file__).with_name("bad").glob("*.yaml"))

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

REPAIRS = {
    "widht": "width", "1e-1": "0.1", "dif}": "diff}", "goal:": "waypoints:", "behaviour": "behavior", "loop: yes, ": "",
    "number: 2.0": "number: 2", "lenght": "length", "state: [3, 3, 0]  #": "#",
}  # fmt: skip
MENDED = functools.reduce(lambda text, repair: text.replace(*repair), REPAIRS.items(), FLAWED)


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
    assert "state: [1, 5, 0], goal: [9, 5]" in repair_text(text).text
    assert "waypoints: [[9, 5]]" in repair_text("robot: {kinematics: {name: diff}, waypoints: [9, 5]}\n").text


def test_lines_below_a_renamed_key_are_their_own() -> None:
    text = "world: {width: 10}\nrobots:\n  - kinematics: {name: diff}\n    position: [1, 5, pi]\n    color: bleu\n"
    repaired = {(repair.finding.code, repair.finding.line) for repair in repair_text(text).repairs}
    assert repaired == {("unknown-key", 2), ("unknown-key", 4), ("wrong-type", 4), ("unknown-color", 5)}


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
    by_hand = "(by hand: --fix does not change it, because comments there would be lost)"
    assert all(fix.endswith(by_hand) for fix in left.values())
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
    assert str(item.fix).startswith("goal: [[9, 5], [9, 7]], or number: 3")


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
    moved = "behavior: {name: follow, local: {name: orca, timeHorizon: 2}, wander: true, target_roles: robot}"
    assert moved in mended.text
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


TEXT = """\
# a scene
world:
  width: 10        # m
  plot: {grid: true,  title: 'a # b'}   # drawn

robot:
  - name: a        # first
    goal: [1, 2]   # there
    behavior:
      name: dash   # straight
      loop: true
    # last words
  - {name: b, goal: [3, 4]}   # second
obstacle:
"""


@pytest.mark.parametrize(
    ("edit", "before", "after"),
    [
        (Edit("replace", ("world", "width"), 12.5), "  width: 10        # m", "  width: 12.5        # m"),
        (Edit("rename", ("robot", 0, "goal"), "waypoints"), "    goal: [1, 2]", "    waypoints: [1, 2]"),
        (Edit("remove", ("robot", 0, "goal")), "    goal: [1, 2]   # there", "    # there"),
        (Edit("remove", ("robot", 0, "name")), "  - name: a        # first\n    goal", "  - goal"),
        (Edit("remove", ("robot", 1, "goal")), "{name: b, goal: [3, 4]}", "{name: b}"),
        (Edit("remove", ("robot", 1, "name")), "{name: b, goal", "{goal"),
        (Edit("remove", ("world", "plot", "grid")), "{grid: true,  title", "{title"),
        (Edit("add", ("robot", 1, "group"), 2), "goal: [3, 4]}", "goal: [3, 4], group: 2}"),
        (
            Edit("add", ("robot", 0, "vel_min"), [0, -1.5]),
            "      loop: true\n    # last",
            "      loop: true\n    vel_min: [0, -1.5]\n    # last",
        ),
        (Edit("replace", ("robot", 0, "behavior"), {"name": "orca"}), None, None),
        (Edit("replace", ("obstacle",), []), "obstacle:", "obstacle: []"),
        (Edit("replace", ("world", "plot", "title"), "yes"), "'a # b'", "'yes'"),
        (Edit("replace", ("robot", 0), "gone"), None, None),
    ],
)
def test_changes_one_place(edit: Edit, before: str | None, after: str | None) -> None:
    changed = rewrite(TEXT, edit)
    assert changed is not None
    assert yaml.safe_load(changed) == apply_edits(yaml.safe_load(TEXT), [edit])
    if before is not None and after is not None:
        assert TEXT.count(before) == 1
        assert changed == TEXT.replace(before, after)


@pytest.mark.parametrize(
    ("text", "edit", "changed"),
    [
        ("a:\n  b: 1  # why\nc: 2\n", Edit("remove", ("a", "b")), "a:\n  {}  # why\nc: 2\n"),
        ("a: 1\r\nb: 2\r\n", Edit("add", ("c",), 3), "a: 1\r\nb: 2\r\nc: 3\r\n"),
        ("a: 1\r\nb: 2\r\n", Edit("remove", ("a",)), "b: 2\r\n"),
        ("a: &x {k: 1}\nb: 2\nc: 3\n", Edit("remove", ("b",)), "a: &x {k: 1}\nc: 3\n"),
        ("a: &x {k: 1}\nb: *x\n", Edit("replace", ("a", "k"), 2), None),  # would change b as well
        ("a: &x {k: 1}\nb: *x\n", Edit("replace", ("b", "k"), 2), None),
        ("a: &x {k: 1}\nb: *x\n", Edit("add", ("b", "l"), 2), None),
        ("a: &x {k: 1}\nb: {<<: *x}\n", Edit("replace", ("b", "k"), 2), None),
        ("a: 1\n", Edit("replace", ("b",), 2), None),
        ("a: 1\n", Edit("rename", ("b", "c"), "d"), None),
        ("a: [1]\n", Edit("remove", ("a", 0)), None),
        ("a: {b: 1}\n", Edit("add", ("a", "b"), 2), None),
        ("a: [", Edit("remove", ("a",)), None),
    ],
)
def test_small_texts_are_changed_or_left_alone(text: str, edit: Edit, changed: str | None) -> None:
    assert rewrite(text, edit) == changed


scalars = (
    st.none() | st.booleans() | st.integers(-99, 99) | st.floats(-1e6, 1e6) | st.text("abc #:-'\"[]{}é\n", max_size=6)
)
trees = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text("abcd", min_size=1, max_size=3), inner, max_size=3)
    ),
    max_leaves=8,
)


def paths(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(deeper for key, item in items for deeper in paths(item, (*path, key)))]


@settings(max_examples=examples(150))
@given(
    st.dictionaries(st.text("xyz", min_size=1, max_size=3), trees, min_size=1, max_size=4),
    trees,
    st.data(),
    st.booleans(),
)
def test_the_text_means_what_the_edit_means(data: dict[str, Any], value: Any, draw: st.DataObject, flow: bool) -> None:
    text = yaml.safe_dump(data, default_flow_style=flow, allow_unicode=True, sort_keys=False)
    places = [path for path in paths(data) if path]
    path = draw.draw(st.sampled_from(places))
    action = draw.draw(st.sampled_from(["remove", "replace", "rename", "add"]))
    edit = Edit(action, (*path[:-1], "new") if action == "add" else path, "renamed" if action == "rename" else value)
    changed = rewrite(text, edit)
    if changed is not None:
        assert _near(yaml.safe_load(changed), apply_edits(data, [edit]))


@settings(max_examples=examples(200))
@given(trees)
def test_a_value_on_one_line_is_read_back(value: Any) -> None:
    line = yaml_flow(value)
    assert "\n" not in line
    back = yaml.safe_load(f"[{line}]")[0]
    assert back == pytest.approx(value, rel=1e-9) if isinstance(value, float) else back == value or _near(back, value)


def _near(a: Any, b: Any) -> bool:
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_near(a[key], b[key]) for key in a)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(_near, a, b))
    return bool(a == b or (isinstance(a, (int, float)) and a == pytest.approx(b, rel=1e-9)))
