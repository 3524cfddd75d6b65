"""Numbers of a question are not lost: the example of a template sets the parameters that they are about."""

from __future__ import annotations

import pytest

from irsim.bundled import templates
from irsim.lookup import lookup


@pytest.mark.parametrize(
    ("question", "template", "setting"),
    [
        ("corridor 2 m wide", "corridor-passing", "--set width=2 "),
        ("corridor 1.8 metres wide 8 m long", "corridor-passing", "--set width=1.8 --set length=8 "),
        ("doorway 1.2 m wide", "doorway", "--set door=1.2 "),
        ("a corridor-passing of width 2.5 m", "corridor-passing", "--set width=2.5 "),
    ],
)
def test_the_example_has_the_numbers_of_the_question(question: str, template: str, setting: str) -> None:
    answer = lookup(question)
    assert question in answer.title
    assert answer.best is not None
    assert answer.best.topic == template
    assert setting in str(answer.best.example)
    words = str(answer.best.example).split(" -o")[0].split("--set ")[1:]
    given = templates.parse_settings([word.strip() for word in words])
    assert templates.fill(templates.load(template), given)


def test_a_number_out_of_range_is_said() -> None:
    answer = lookup("corridor 20 m wide").best
    assert answer is not None
    assert answer.text.startswith("width = 20 is out of range. Here give a number from 1.2 to 4 m.")


def test_a_size_does_not_decide_the_topic() -> None:
    asked, plain = lookup("narrow doorway 0.9 m"), lookup("narrow doorway")
    assert asked.best is not None
    assert plain.best is not None
    assert asked.best.topic == plain.best.topic
