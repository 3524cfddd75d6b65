"""Purposes and comments of templates stay true when parameters are changed."""

from __future__ import annotations

import re

import pytest

from irsim.bundled import templates
from irsim.bundled.templates import Parameter

pytestmark = pytest.mark.one_python

_WORDS = {
    2: "two",
    3: "three",
    4: "four",
    5: "five",
    6: "six",
    8: "eight",
    10: "ten",
    16: "sixteen",
    20: "twenty",
    30: "thirty",
}
"""Counts in words."""


def comments_of(text: str) -> str:
    """The comments of a scenario; those on a line with a value that follows a parameter count, too."""
    return "\n".join(line.partition("#")[2] for line in text.splitlines() if re.search(r"(^|\s)#\s", line))


def states_default(text: str, name: str, one: Parameter) -> bool:
    """Whether a text says what holds with the default of a parameter only."""
    if one.type == "integer":
        counted = rf"\b({_WORDS.get(int(one.default), one.default)}|{one.default})\b(?! of)"
        nouns = "|".join({name, name.removesuffix("s"), *(["people", "persons", "pedestrians"] * (name == "people"))})
        return bool(re.search(rf"{counted} (\w+ )?({nouns})\b", text, re.IGNORECASE))
    if one.type == "number" and one.unit not in (None, "1"):
        return bool(re.search(rf"(?<![\d.])0*{one.default:g}( {one.unit}\b|, \d+)", text))
    return one.type == "boolean" and one.default is True and bool(re.search(rf"\b{name}\b", text))


@pytest.mark.parametrize("name", templates.names())
def test_texts_do_not_state_what_a_parameter_changes(name: str) -> None:
    template = templates.load(name)
    for parameter, one in template.parameters.items():
        ends = [end for end in (*one.choices, one.min, one.max) if end is not None and end != one.default]
        for end in [*ends, *([not one.default] if one.type == "boolean" else [])]:
            filled = templates.fill(template, {parameter: end})
            for text in (template.title, template.purpose, comments_of(filled)):
                assert not states_default(text, parameter, one), f"{parameter}={end}: {text}"


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("A robot crosses a plaza on which thirty people stroll about.", "people"),
        ("the passage is 1.8 m wide before and after the bend", "width"),
        ("Polygons stand in its way: all are convex", "convex"),
    ],
)
def test_texts_that_would_lie_are_found(text: str, name: str) -> None:
    home = {"people": "crowd", "width": "l-passage", "convex": "random-polygons"}[name]
    assert states_default(text, name, templates.load(home).parameters[name])
