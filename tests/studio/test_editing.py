"""Edits of the studio in the text: a drag changes the numbers of one list, and nothing else of the file."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import Any

import pytest
import yaml

import irsim
from irsim.scenario.limits import DEFAULT_LIMITS
from irsim.studio.checking import check
from irsim.studio.editing import NotEdited, edit

TEMPLATES = sorted((Path(__file__).parents[2] / "templates").glob("*/scenario.yaml"))
BAD = sorted((Path(__file__).parents[1] / "scenario" / "bad").glob("*.yaml"))
SCENE = """\
# two
robot:
  - {name: a, kinematics: {name: diff}, state: [1.0, 2, 0.5], goal: [[5, 5], [6, 5]]}   # the first
  - {name: b, state: &start [3, 3]}
obstacle: {shape: {name: circle, radius: 0.5}, state: *start}
"""


def edited(text: str, **one: Any) -> str:
    return edit(text, [one], DEFAULT_LIMITS)


def lines_that_differ(before: str, after: str) -> list[str]:
    return [line for line in difflib.ndiff(before.splitlines(), after.splitlines()) if line[0] in "+-"]


@pytest.mark.parametrize("file", TEMPLATES, ids=lambda file: file.parent.name)
def test_each_pose_and_goal_of_a_template_is_dragged_in_its_own_line(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    answer = check(text, str(file), None, DEFAULT_LIMITS)
    assert answer["findings"] == irsim.validate(file).model_dump()["findings"]
    places = answer["objects"]
    assert all(("pose" in place) != ("why" in place) for place in places)
    for path in [path for place in places for path in (place.get("pose"), *place.get("goals", [])) if path]:
        changed = edited(text, action="numbers", path=path, value=[1.23, 4.56])
        before, after = lines_that_differ(text, changed) or ("-", "+")
        assert (before[0], after[0]) == ("-", "+")
        data: Any = yaml.safe_load(changed)
        for part in path:
            data = data[part]
        assert data[:2] == [1.23, 4.56]


def test_numbers_keep_the_length_of_their_list_and_what_stays_as_it_was_written() -> None:
    moved = edited(SCENE, action="numbers", path=["robot", 0, "state"], value=[1.0, 2.5])
    assert moved == SCENE.replace("[1.0, 2, 0.5]", "[1.0, 2.5, 0.5]")
    turned = edited(SCENE, action="numbers", path=["robot", 0, "state"], value=[1, 2, 0.75])
    assert turned == SCENE.replace("[1.0, 2, 0.5]", "[1.0, 2, 0.75]")
    goal = edited(SCENE, action="numbers", path=["robot", 0, "goal", 1], value=[6, 5.5])
    assert goal == SCENE.replace("[6, 5]", "[6, 5.5]")


def test_what_several_places_share_is_not_changed() -> None:
    with pytest.raises(NotEdited, match="written once for several places"):
        edited(SCENE, action="numbers", path=["obstacle", "state"], value=[4, 4])


def test_objects_are_added_copied_and_removed_in_lists_and_alone() -> None:
    new = {"name": "c", "state": [7, 7]}
    added = edited(SCENE, action="append", path=["robot"], value=new)
    assert yaml.safe_load(added)["robot"][2] == new
    assert added.startswith(SCENE[: SCENE.index("obstacle")])
    two = edited(SCENE.replace("*start", "[4, 4]"), action="duplicate", path=["obstacle"])
    assert [one["state"] for one in yaml.safe_load(two)["obstacle"]] == [[4, 4], [4.5, 3.5]]
    named = edited(SCENE, action="duplicate", path=["robot", 0])
    assert [one["name"] for one in yaml.safe_load(named)["robot"]] == ["a", "a_2", "b"]
    assert "obstacle" not in yaml.safe_load(edited(SCENE, action="delete", path=["obstacle"]))
    first = edited("world: {width: 5}\n", action="append", path=["robot"], value=new)
    assert yaml.safe_load(first) == {"world": {"width": 5}, "robot": [new]}


@pytest.mark.parametrize("action", ["", "write", "__class__"])
def test_other_actions_are_refused(action: str) -> None:
    with pytest.raises(NotEdited):
        edited(SCENE, action=action, path=["robot", 0], value=1)


def test_a_place_says_where_its_object_is_written() -> None:
    places = check(SCENE.replace("*start", "[4, 4]"), None, None, DEFAULT_LIMITS)["objects"]
    assert [place["lines"] for place in places] == [[3, 3], [4, 4], [5, 5]]
    many = "robot:\n  - number: 3\n    distribution: {name: circle, radius: 3}\n    goal: [1, 1]\n"
    assert [place["why"] for place in check(many, None, None, DEFAULT_LIMITS)["objects"]] == [
        "it is one of 3 that one entry makes"
    ] * 3


def test_each_of_several_objects_with_a_state_of_its_own_is_dragged_alone() -> None:
    text = "robot:\n  - number: 2\n    state: [[1, 1, 0], [2.5, 2, 0]]   # both\n    goal: [9, 9]\n"
    paths = [place["pose"] for place in check(text, None, None, DEFAULT_LIMITS)["objects"]]
    assert paths == [["robot", 0, "state", 0], ["robot", 0, "state", 1]]
    assert edited(text, action="numbers", path=paths[1], value=[3, 2]) == text.replace("[2.5, 2, 0]", "[3, 2, 0]")


@pytest.mark.parametrize("file", BAD, ids=lambda file: file.stem)
def test_findings_are_those_of_irsim_validate(file: Path) -> None:
    text = file.read_bytes().decode(errors="replace")
    told = [{**one, "file": None} for one in check(text, None, None, DEFAULT_LIMITS)["findings"]]
    assert told == [{**one, "file": None} for one in irsim.validate(text=text).model_dump()["findings"]]
