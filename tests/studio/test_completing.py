"""Completion at the cursor: keys and values of the language that fit there, in texts that are not finished."""

from __future__ import annotations

from pathlib import Path

import pytest

from irsim.studio.completing import complete

TEMPLATES = sorted((Path(__file__).parents[2] / "templates").glob("*/scenario.yaml"))


def labels(text: str) -> list[str]:
    """Labels at the sign ``|`` of a text."""
    before, _, after = text.partition("|")
    line = before.count("\n") + 1
    column = len(before) - (before.rfind("\n") + 1)
    return [option["label"] for option in complete(before + after, line, column)["options"]]


@pytest.mark.parametrize(
    ("text", "first"),
    [
        ("ro|", "robot"),
        ("world: {width: 10, hei|", "height"),
        ("world:\n  collision_mode: st|\nrobot: {}\n", "stop"),
        ("robot:\n  - kinematics: {name: di|}\n    goal: [1, 1]\n", "diff"),
        ("robot:\n  - kinematics: |\n    goal: [1, 1]\n", "acker"),
        ("robot:\n  - name: a\n    sensors:\n      - {name: lidar2d, ran|}\n", "range_min"),
        ("robot:\n  - sensors: [{name: ultra|", "sonar"),
        ("obstacle:\n  - {kinematics: {name: omni}, beh|}\n", "behavior"),
        ("robot:\n  - sensors: [{name: lidar2d, noise: t|", "true"),
        ("robot:\n  - name: a\n    |\nobstacle: []\n", "number"),
    ],
)
def test_the_first_word(text: str, first: str) -> None:
    assert labels(text)[0] == first


def test_a_key_comes_with_unit_default_and_meaning_and_is_not_offered_twice() -> None:
    text = "robot:\n  - sensors: [{name: lidar2d, range_m}]\n"
    [least, most] = complete(text, 2, text.index("}]") - text.index("  -"))["options"]
    assert (most["label"], most["apply"], most["detail"]) == ("range_max", "range_max: ", "m, default 10")
    assert most["info"].startswith("Length of the beams")
    assert least["label"] == "range_min"
    assert "range_max" not in labels("robot:\n  - sensors: [{name: lidar2d, range_max: 3, ra|}]\n")


def test_options_of_a_component_are_those_of_its_name() -> None:
    assert "timeHorizon" in labels("robot: {behavior: {name: orca, |}}\n")
    assert "timeHorizon" not in labels("robot: {behavior: {name: dash, |}}\n")


@pytest.mark.parametrize("text", ["", "|", "\t|", "a: [|", "- - |", "'|", "robot: {{|", "x: |\n" * 2])
def test_any_text_is_answered(text: str) -> None:
    assert isinstance(labels(text), list)
    assert complete("a", 99, 0) == {"column": 0, "options": []}


@pytest.mark.parametrize("file", TEMPLATES[::6], ids=lambda file: file.parent.name)
def test_every_key_of_a_template_is_offered_where_it_stands(file: Path) -> None:
    lines = file.read_text(encoding="utf-8").split("\n")
    for number, row in enumerate(lines, 1):
        word, colon, _ = row.partition(":")
        if not colon or not word.strip() or not word.replace("-", " ").strip().isidentifier():
            continue
        name = word.replace("-", " ").strip()
        text = "\n".join([*lines[: number - 1], row[: len(word) - 1], *lines[number:]])
        offered = [one["label"] for one in complete(text, number, len(word) - 1)["options"]]
        assert name in offered, f"line {number}: {name} not in {offered}"
