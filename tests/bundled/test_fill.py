"""Parameters edit the text of a template and nothing else; wrong ones are refused with help."""

import pytest
import yaml

from irsim.bundled.templates import Template, TemplateError, fill, parse_settings
from irsim.bundled.templates.fill import evaluate, parse_path, replace_values

pytestmark = pytest.mark.one_python

TEXT = """\
# a room
world:
  width: 10        # m
  height: 8
robot:
  - {shape: {name: circle, radius: 0.3}, goal: [8.5, 6.5, 0]}   # the goal
"""


@pytest.fixture
def room() -> Template:
    about = {"name": "room", "title": "Room", "purpose": "A room.", "tags": ["room"], "outcomes": ["success"]}
    parameters = {
        "width": {"type": "number", "default": 10, "min": 2, "max": 50, "unit": "m", "description": "Extent."},
        "count": {"type": "integer", "default": 1, "min": 1, "description": "How many."},
        "drive": {"type": "choice", "default": "diff", "choices": ["diff", "omni"], "description": "Drive."},
        "walls": {"type": "boolean", "default": True, "description": "Walls."},
    }
    sets = {"world.width": "width", "robot[0].goal": "[width - 1.5, 6.5, 0]"}
    return Template.model_validate({**about, "parameters": parameters, "sets": sets, "text": TEXT})


def test_defaults_leave_the_text_as_it_is(room: Template) -> None:
    assert fill(room) == TEXT


def test_a_parameter_changes_its_values_and_keeps_comments_in_their_column(room: Template) -> None:
    filled = fill(room, {"width": "12.25"})
    assert "  width: 12.25     # m\n" in filled
    assert "goal: [10.75, 6.5, 0]}   # the goal" in filled
    changed = [(a, b) for a, b in zip(TEXT.splitlines(), filled.splitlines(), strict=True) if a != b]
    assert len(changed) == 2


@pytest.mark.parametrize(
    ("given", "code", "help_text"),
    [
        ({"widht": 3}, "unknown-parameter", "width"),
        ({"nonsense": 3}, "unknown-parameter", "drive"),
        ({"width": 300}, "bad-parameter", "from 2 to 50 m"),
        ({"width": "wide"}, "bad-parameter", "a number"),
        ({"width": "nan"}, "bad-parameter", "a number"),
        ({"width": True}, "bad-parameter", "a number"),
        ({"count": "1.5"}, "bad-parameter", "an integer"),
        ({"count": 0}, "bad-parameter", "at least 1"),
        ({"drive": "acker"}, "bad-parameter", "diff, omni"),
        ({"walls": "maybe"}, "bad-parameter", "true, false"),
    ],
)
def test_wrong_parameters_are_refused_with_what_is_accepted(
    room: Template, given: dict[str, object], code: str, help_text: str
) -> None:
    with pytest.raises(TemplateError) as caught:
        fill(room, given)
    assert caught.value.code == code
    assert help_text in str(caught.value)


def test_only_the_default_parameters_promise_an_outcome(room: Template) -> None:
    assert room.prospect() == room.prospect({"width": 10}) == "With the default parameters it ends in success."
    assert "with width=12 it may end otherwise" in room.prospect({"width": 12})


def test_text_is_converted_to_the_type_of_the_parameter(room: Template) -> None:
    values = room.values({"width": "3", "count": "2", "drive": "omni", "walls": "off"})
    assert values == {"width": 3.0, "count": 2, "drive": "omni", "walls": False}


def test_settings_are_split_at_the_first_equals_sign() -> None:
    assert parse_settings(["width=1.6", " title = a=b "]) == {"width": "1.6", "title": "a=b"}


@pytest.mark.parametrize("setting", ["width", "=3", "width=", ""])
def test_what_is_not_a_setting_is_refused(setting: str) -> None:
    with pytest.raises(TemplateError, match="KEY=VALUE"):
        parse_settings([setting])


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("2 * a + 1", 7),
        ("[a, -a, a / 2]", [3, -3, 1.5]),
        ("1 if a > 2 else 5", 1),
        ("{'name': kind, 'radius': a / 2}", {"name": "y", "radius": 1.5}),
        ("1 if kind == 'x' else 5", 5),
        ("max(a, 10) // 4", 2),
        ("round(pi * a)", 9),
        ("[7, 5, 2][a - 1]", 2),
    ],
)
def test_expressions(expression: str, expected: object) -> None:
    assert evaluate(expression, {"a": 3, "kind": "y"}) == expected


HARMFUL = ["a ** 9 ** 9", "__import__('os')", "[x for x in 'ab']", "'a' * 3", "(lambda: 1)()", "f'{a}'", "a.real"]


@pytest.mark.parametrize("expression", [*HARMFUL, "b", "[1][-1]", "[1][0.5]", "'a'[0]"])
def test_expressions_can_do_no_more_than_arithmetic(expression: str) -> None:
    with pytest.raises(ValueError, match="template expression"):
        evaluate(expression, {"a": 3})


def test_paths_are_those_of_diagnostics() -> None:
    assert parse_path("robot[0].sensors[1].offset[2]") == ("robot", 0, "sensors", 1, "offset", 2)


def test_replacing_writes_what_yaml_reads_back() -> None:
    changes = {
        ("world", "width"): 1 / 3,
        ("robot", 0, "shape", "name"): "polygon",
        ("robot", 0, "goal"): [[1.0, -0.0], [2.5, True]],
    }
    data = yaml.safe_load(replace_values(TEXT, changes))
    assert data["world"] == {"width": 0.333333, "height": 8}
    assert data["robot"][0] == {"shape": {"name": "polygon", "radius": 0.3}, "goal": [[1, 0], [2.5, True]]}


def test_mappings_are_written_as_yaml_and_left_alone_if_they_are_the_same() -> None:
    text = "behavior: {name: orca, timeHorizon: 3}   # both\n"
    assert replace_values(text, {("behavior",): {"name": "orca", "timeHorizon": 3.0}}) == text
    changed = replace_values(text, {("behavior",): {"name": "rvo", "vxmax": 0.5}})
    assert yaml.safe_load(changed) == {"behavior": {"name": "rvo", "vxmax": 0.5}}
    assert changed.rstrip().endswith("# both")
