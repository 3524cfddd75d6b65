"""``irsim.diff``: what an edit changed, in the file and in the world."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

import irsim
from irsim.bundled import templates
from irsim.cli.app import app
from irsim.common.text import names_if_different, rounded_pair, shorten_pair

BASE = """\
world: {width: 10, height: 8, seed: 3}   # the hall
robot:
  - name: scout
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.3}
    state: [1, 4, 0]   # by the door
    goal: [9, 4]
    vel_max: [1.0, 1.5]
    vel_min: [-1.0, -1.5]
    behavior: {name: dash}
    sensors: [{name: lidar2d, number: 90, range_max: 4}]
obstacle:
  - {shape: {name: rectangle, length: 1, width: 2}, state: [5, 6, 0]}
  - {shape: {name: circle, radius: 0.5}, state: [5, 1, 0]}
"""


def diff(before: str, after: str) -> irsim.results.validation.ScenarioDiff:
    return irsim.diff(before_text=before, after_text=after)


def keys(difference: irsim.results.validation.ScenarioDiff) -> list[tuple[str, str]]:
    return [(change.change, change.path) for change in difference.keys]


def world(difference: irsim.results.validation.ScenarioDiff) -> list[tuple[str, str | None, str | None]]:
    assert difference.world is not None
    return [(change.change, change.object, change.key) for change in difference.world]


def test_a_file_does_not_differ_from_itself_written_otherwise() -> None:
    other = (
        "obstacle:\n- state: [5.0, 6, 0]\n  shape: {length: 1.0, name: rectangle, width: 2}\n"
        "- {shape: {name: circle, radius: 0.5}, state: [5, 1, 0]}\n"
        + BASE.partition("obstacle:")[0].replace("   #", "  #")
    )
    difference = diff(BASE, other)
    assert (difference.same, difference.keys, difference.world, difference.comments_lost) == (True, [], [], [])


def test_one_value_is_one_key_and_one_fact() -> None:
    difference = diff(BASE, BASE.replace("number: 90", "number: 181"))
    assert keys(difference) == [("changed", "robot[0].sensors[0].number")]
    assert world(difference) == [("changed", "scout", "sensors[0].number")]
    change = difference.keys[0]
    assert (change.before, change.after, difference.lines_removed, difference.lines_added) == (90, 181, 1, 1)


def test_what_comes_before_does_not_shift_the_rest() -> None:
    entry = "  - {shape: {name: circle, radius: 0.2}, state: [8, 2, 0]}\n"
    difference = diff(BASE, BASE.replace("obstacle:\n", f"obstacle:\n{entry}"))
    assert keys(difference) == [("added", "obstacle[0]")]
    assert world(difference) == [("added", "obstacle_1", None)]
    back = diff(BASE.replace("obstacle:\n", f"obstacle:\n{entry}"), BASE)
    assert keys(back) == [("removed", "obstacle[0]")]
    assert [item[0] for item in world(back)] == ["removed"]


def test_a_default_written_out_changes_the_file_but_not_the_world() -> None:
    difference = diff(BASE, BASE.replace("goal: [9, 4]", "goal: [9, 4]\n    goal_threshold: 0.1"))
    assert keys(difference) == [("added", "robot[0].goal_threshold")]
    assert world(difference) == []
    assert not difference.same


def test_entries_are_the_same_with_decimal_points_and_keys_in_another_order() -> None:
    before = "obstacle:\n  - {state: [5, 1, 0], name: a}\n  - {shape: {name: circle, radius: 1}, state: [5, 6]}\n"
    after = (
        "obstacle:\n  - {name: a, state: [5.0, 1.0, 0.0]}\n  - {state: [5.0, 6], shape: {radius: 1.0, name: circle}}\n"
    )
    assert diff(before, after).same


def test_a_sensor_is_the_same_by_either_word() -> None:
    difference = diff(BASE, BASE.replace("name: lidar2d", "type: lidar2d"))
    assert difference.world == []


PAIR = (
    "robot:\n  - {number: 2, kinematics: {name: omni}, state: [[1, 3, 0], [1, 5, 0]], goal: [[9, 3], [9, 5]], "
    "shape: {name: circle, radius: 0.2}, behavior: {name: dash}}\n"
)
SINGLES = "robot:\n" + "".join(
    f"  - {{kinematics: {{name: omni}}, state: [1, {y}, 0], goal: [9, {y}], shape: {{name: circle, radius: 0.2}}, "
    "behavior: {name: dash}}\n"
    for y in (3, 5)
)


def test_an_entry_for_two_robots_is_two_entries() -> None:
    for difference in (diff(PAIR, SINGLES), diff(SINGLES, PAIR)):
        assert difference.keys
        assert difference.world == []
        assert difference.summary.endswith("; the worlds are the same")


def test_what_changes_while_an_entry_is_split_is_told() -> None:
    moved = diff(PAIR, SINGLES.replace("[1, 5, 0]", "[1, 6, 0]"))
    assert world(moved) == [("changed", "robot_1", "pose")]
    assert [fact.direct for fact in moved.world or []] == [False]
    assert moved.summary.endswith("which also changes robot_1")
    more = diff(PAIR, SINGLES + "  - {kinematics: {name: omni}, state: [1, 8, 0], goal: [9, 8]}\n")
    assert world(more) == [("added", "robot_2", None)]


def test_one_of_several_is_the_one_that_is_gone() -> None:
    less = diff(PAIR, PAIR.replace("number: 2", "number: 1").replace("[1, 3, 0], ", "").replace("[9, 3], ", ""))
    assert [(fact.change, fact.before["pose"]) for fact in less.world or []] == [("removed", [1, 3, 0])]


def test_lost_comments_are_told() -> None:
    difference = diff(BASE, BASE.replace("   # by the door", ""))
    assert (difference.same, difference.comments_lost) == (True, ["# by the door"])


def test_another_drive_changes_what_follows_from_it() -> None:
    difference = diff(BASE, BASE.replace("{name: diff}", "{name: omni}"))
    assert keys(difference) == [("changed", "robot[0].kinematics.name")]
    assert ("changed", "scout", "kinematics") in world(difference)


def test_with_an_invalid_file_only_the_keys_are_compared() -> None:
    difference = diff(BASE, BASE.replace("radius: 0.3", "radius: -1"))
    assert keys(difference) == [("changed", "robot[0].shape.radius")]
    assert difference.world is None
    assert "invalid" in difference.summary


def test_facts_that_only_repeat_a_key_are_marked() -> None:
    moved = diff(
        BASE, BASE.replace("[9, 4]", "[9, 5]").replace("[1, 4, 0]", "[1, 5, 0]").replace("radius: 0.3", "radius: 0.4")
    )
    assert {fact.key for fact in moved.world or []} == {"goals", "pose", "shape.radius"}
    assert all(fact.direct for fact in moved.world or [])
    assert "which also changes" not in moved.summary
    entry = "  - {shape: {name: circle, radius: 0.2}, state: [8, 2, 0]}\n"
    one = diff(BASE, BASE + entry).world or []
    assert [fact.direct for fact in one] == [True]
    several = diff(BASE, BASE + entry.replace("{shape", "{number: 3, shape")).world or []
    assert [fact.direct for fact in several] == [False] * 3


def test_what_follows_from_a_key_is_not_marked() -> None:
    unlimited = BASE.replace("    vel_max: [1.0, 1.5]\n", "").replace("    vel_min: [-1.0, -1.5]\n", "")
    default = [fact for fact in diff(BASE, unlimited).world or [] if fact.key == "vel_max"]
    assert [fact.direct for fact in default] == [False]  # the key says only that it is gone
    difference = diff(unlimited, unlimited.replace("{name: diff}", "{name: acker, wheelbase: 1}"))
    told = {fact.key: fact.direct for fact in difference.world or []}
    assert told["kinematics"]
    assert not all(told.values())
    assert "which also changes scout" in difference.summary


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("# by the door", "# by the back door"),
        ("# by the door", "# starts"),
        ("# the hall", "# 10 x 8 m"),
        ("# who moves", "# one robot"),
    ],
)
def test_a_comment_about_the_same_thing_is_edited(before: str, after: str) -> None:
    old = BASE.replace("robot:\n", "# who moves\nrobot:\n")
    difference = diff(old, old.replace(before, after))
    assert difference.comments_lost == []
    assert [(item.before, item.after) for item in difference.comments_changed] == [(before, after)]
    assert difference.summary.endswith("no comment lost, 1 comment changed")
    invalid = diff(old, old.replace(before, after).replace("radius: 0.3", "radius: -1"))
    assert [(item.before, item.after) for item in invalid.comments_changed] == [(before, after)]


def test_another_comment_about_something_else_does_not_replace_one() -> None:
    difference = diff(BASE, BASE.replace("   # by the door", "").replace("goal: [9, 4]", "goal: [9, 4]   # east"))
    assert (difference.comments_lost, difference.comments_changed) == (["# by the door"], [])


@pytest.mark.parametrize(
    "text", ["robot: 5   # five\n", "- 1   # one\n", "robot: [   # open\n", "# nothing\n", "5   # x"]
)
def test_comments_of_what_is_no_scenario(text: str) -> None:
    assert diff(BASE, text).comments_lost
    assert diff(text, text.replace("# ", "# not ")).comments_lost == []


def test_a_comment_goes_with_its_entry() -> None:
    entries = ["  # slow\n  - {state: [5, 1, 0]}\n", "  - {state: [5, 6, 0]}   # fast\n"]
    before = f"obstacle:\n{entries[0]}{entries[1]}"
    after = f"obstacle:\n{entries[1].replace('fast', 'quick')}{entries[0].replace('slow', 'dawdling')}"
    difference = diff(before, after)
    assert difference.comments_lost == []
    assert {(item.before, item.after) for item in difference.comments_changed} == {
        ("# slow", "# dawdling"),
        ("# fast", "# quick"),
    }
    gone = diff(before, f"obstacle:\n{entries[1]}")
    assert (gone.comments_lost, gone.comments_changed) == (["# slow"], [])


def test_equal_comments_stand_for_themselves() -> None:
    before = "obstacle:\n  - {state: [5, 1, 0]}   # here\n  - {state: [5, 6, 0]}   # here\n"
    difference = diff(before, before.replace("# here", "# 5, 1", 1))
    assert [(item.before, item.after) for item in difference.comments_changed] == [("# here", "# 5, 1")]
    assert difference.comments_lost == []


def test_an_entry_that_is_gone_is_named_as_in_the_file_before() -> None:
    before = "obstacle:\n" + "".join(
        f"  - {{shape: {{name: circle, radius: {radius}}}, state: [{x}, 8, 0]}}\n"
        for x, radius in ((5, 0.4), (6, 0.5), (7, 0.6))
    )
    lines = before.splitlines(keepends=True)
    difference = diff(before, "".join([*lines[:2], lines[3].replace("0.6", "0.7")]))
    assert difference.summary == "2 keys differ: obstacle[1].shape.radius, former obstacle[1]"
    result = diff(BASE, BASE.replace("    goal: [9, 4]\n", ""))
    assert result.summary.startswith("1 key differs: robot[0].goal;")


def test_long_values_are_cut_where_they_differ() -> None:
    before, after = shorten_pair("a" * 200 + "1" + "b" * 200, "a" * 200 + "2" + "b" * 200, 60)
    assert max(len(before), len(after)) == 60
    assert before.replace("1", "2") == after != before
    assert shorten_pair("short", "shorter") == ("short", "shorter")


def test_validation_can_say_what_changed(tmp_path: Path) -> None:
    path = tmp_path / "hall.yaml"
    path.write_text(BASE.replace("[9, 4]", "[9, 5]"), encoding="utf-8")
    report = irsim.validate(path, base_text=BASE)
    assert report.changes is not None
    assert [change.path for change in report.changes.keys] == ["robot[0].goal"]
    assert [(fact.object, fact.key) for fact in report.changes.world or []] == [("scout", "goals")]


@pytest.mark.parametrize("name", ["mixed-fleet", "crowd", "cave", "random-polygons", "fog-exploration", "sorting"])
def test_templates_equal_themselves(name: str) -> None:
    text = templates.load(name).text
    assert diff(text, text).same


def test_a_change_of_order_is_told() -> None:
    entry = "  - {name: %s, kinematics: {name: diff}, state: [%d, 1, 0], goal: [%d, 5], behavior: {name: dash}}\n"
    lines = [entry % (name, x, x) for name, x in (("a", 1), ("b", 3), ("c", 5))]
    before, swapped = ("robot:\n" + "".join(lines[i] for i in order) for order in ((0, 1, 2), (1, 0, 2)))
    difference = irsim.diff(before_text=before, after_text=swapped)
    assert not difference.same
    assert [(key.change, key.before, key.after) for key in difference.keys] == [("moved", "robot[1]", "robot[0]")]
    assert difference.summary.startswith(
        "no key differs but for the order: robot[1] is now robot[0], which changes ids"
    )
    assert difference.summary.endswith("which robot env.step(action) drives")
    without = "robot:\n" + "".join(lines[1:])
    assert [key.change for key in irsim.diff(before_text=before, after_text=without).keys] == ["removed"]
    edited = swapped.replace("[1, 5]", "[2, 5]")
    told = irsim.diff(before_text=before, after_text=edited)
    assert sorted(key.change for key in told.keys) == ["changed", "moved"]
    assert told.summary.startswith("1 key differs: robot[1].goal")
    assert "; the order differs: robot[1] is now robot[0]" in told.summary


def robot(y: int, more: str = "", drive: str = "diff") -> str:
    return (
        f"  - {{kinematics: {{name: {drive}}}, shape: {{name: circle, radius: 0.3}}, state: [1, {y}, 0], "
        f"goal: [9, {y}]{more}}}\n"
    )


LED = (
    "robot:\n" + robot(2, ", group: 0, group_behavior: {name: orca}") + robot(4, ", group: 0") + robot(6, ", group: 0")
)


def told(
    difference: irsim.results.validation.ScenarioDiff,
) -> dict[tuple[str | None, str | None], tuple[object, object]]:
    """Changes of the world, by object and fact; of options their name."""
    facts = difference.world or []
    return {(fact.object, fact.key): (_name(fact.before), _name(fact.after)) for fact in facts}


def _name(value: object) -> object:
    return value.get("name") if isinstance(value, dict) else value


def test_who_leaves_a_group_is_no_longer_led_by_its_behavior() -> None:
    difference = diff(LED, LED.replace("[9, 6], group: 0", "[9, 6], group: 1"))
    assert told(difference) == {("robot_2", "group_behavior"): ("orca", None)}
    assert difference.summary == "1 key differs: robot[2].group; which also changes robot_2"
    back = diff(LED.replace("[9, 6], group: 0", "[9, 6], group: 1"), LED)
    assert told(back) == {("robot_2", "group_behavior"): (None, "orca")}


def test_a_group_behavior_is_told_of_all_that_follow_it() -> None:
    gone = diff(LED, LED.replace(", group_behavior: {name: orca}", ""))
    assert told(gone) == {(f"robot_{i}", "group_behavior"): ("orca", None) for i in range(3)}
    other = diff(LED, LED.replace("orca", "sfm"))
    assert told(other) == {(f"robot_{i}", "group_behavior"): ("orca", "sfm") for i in range(3)}
    option = diff(LED, LED.replace("{name: orca}", "{name: orca, safe_radius: 0.3}"))
    assert {fact.key for fact in option.world or []} == {"group_behavior.safe_radius"}
    assert [(fact.object, fact.direct) for fact in option.world or []] == [
        ("robot_0", True),
        ("robot_1", False),
        ("robot_2", False),
    ]


def test_people_are_told_of_options_by_their_name(tmp_path: Path) -> None:
    before, after = tmp_path / "before.yaml", tmp_path / "after.yaml"
    before.write_text(LED, encoding="utf-8")
    after.write_text(LED.replace("[9, 6], group: 0", "[9, 6], group: 1"), encoding="utf-8")
    shown = CliRunner().invoke(app, ["diff", str(before), str(after)])
    assert "~ robot_2 group_behavior  orca -> null" in shown.stdout.splitlines()
    assert names_if_different({"name": "orca", "a": 1}, {"name": "orca", "a": 2}) == (
        {"name": "orca", "a": 1},
        {"name": "orca", "a": 2},
    )
    assert names_if_different([1], None) == ([1], None)


def test_of_many_entries_that_all_changed_each_is_recognised() -> None:
    before = "robot:\n" + "".join(robot(2 + i) for i in range(120))
    difference = diff(f"world: {{height: 200}}\n{before}", f"world: {{height: 200}}\n{before.replace('0.3', '0.4')}")
    assert {change for change, _ in keys(difference)} == {"changed"}
    assert len(difference.keys) == len(difference.world or []) == 120
    assert all(fact.direct for fact in difference.world or [])


def test_a_group_behavior_that_nobody_follows_changes_no_world() -> None:
    unused = LED.replace("[9, 4], group: 0", "[9, 4], group: 0, group_behavior: {name: sfm}")
    assert keys(diff(LED, unused)) == [("added", "robot[1].group_behavior")]
    assert world(diff(LED, unused)) == []
    assert world(diff(LED, LED.replace("group: 0", "group: 7"))) == []


def test_an_obstacle_taken_out_of_the_group_of_the_robots_is_told() -> None:
    obstacle = "obstacle: {kinematics: {name: omni}, state: [5, 1, 0], goal: [5, 9], shape: {name: circle, radius: 0.2}"
    difference = diff(f"{LED}{obstacle}, group: 0}}\n", f"{LED}{obstacle}, group: 1}}\n")
    assert told(difference) == {("obstacle_3", "group_behavior"): ("orca", None)}


def test_another_group_of_the_same_behavior_is_other_company() -> None:
    leader = robot(7, ", group: 1, group_behavior: {name: orca}") + robot(8, ", group: 1")
    two = LED.replace("robot:\n", f"robot:\n{leader}")
    difference = diff(two, two.replace("[9, 6], group: 0", "[9, 6], group: 1"))
    assert told(difference) == {
        ("robot_4", "group_members"): (["robot_2", "robot_3", "robot_4"], ["robot_0", "robot_1", "robot_4"])
    }
    first = diff(LED + leader, (LED + leader).replace("[9, 6], group: 0", "[9, 6], group: 1"))  # it leads now
    assert told(first) == {(f"robot_{i}", "group_behavior"): ("orca", None) for i in (2, 3, 4)}


@pytest.mark.parametrize(
    ("before", "after", "fact"),
    [
        ("goal: [9, 2]", "goal: [9, 2], angle_range: [0, 6.283185307]", "angle_range"),
        ("state: [1, 2, 0]", "state: [1, 2, 0, 0.2]", "extra_state"),
        ("goal: [9, 2]", "goal: [9, 2], group_name: walkers", "group_name"),
        ("goal: [9, 2]", "goal: [9, 2], fov_occlusion: true", "fov_occlusion"),
    ],
)
def test_small_facts_are_facts(before: str, after: str, fact: str) -> None:
    text = "robot:\n" + robot(2, ", behavior: {name: dash}").replace("diff", "acker, wheelbase: 1")
    difference = diff(text, text.replace(before, after))
    assert [(item.object, item.key) for item in difference.world or []] == [("robot_0", fact)]


def test_a_finding_of_an_entry_that_has_moved_is_known_from_the_base() -> None:
    shared = "kinematics: {name: diff}, behavior: {name: dash}"
    slow = f"  - {{name: slow, {shared}, state: [1, 1, 0], goal: [9, 1, 0], vel_max: [0, 1]}}\n"
    fast = f"  - {{name: fast, {shared}, state: [1, 4, 0], goal: [9, 4, 0]}}\n"
    world = "world: {width: 12, height: 6}\nrobot:\n"
    report = irsim.validate(text=world + fast + slow, base_text=world + slow + fast)
    known = [(finding.path, finding.in_base) for finding in report.findings if "slow" in finding.message]
    assert known
    assert all(path.startswith("robot[1]") and in_base for path, in_base in known)


def test_numbers_are_rounded_unless_that_hides_the_difference() -> None:
    assert rounded_pair([1.45963036, -0.0000001], {"pose": 2.0}) == ([1.46, 0.0], {"pose": 2.0})
    assert rounded_pair(1.00001, 1.00002) == (1.00001, 1.00002)
    assert rounded_pair(None, {"goals": [[10.93251619, 5]]}) == (None, {"goals": [[10.933, 5]]})
