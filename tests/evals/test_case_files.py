"""What is wrong with a case is found when it is read, not when an answer is graded."""

from __future__ import annotations

from typing import Any

import pytest
from pydantic import ValidationError

from irsim_evals.cases.model import Assertion
from irsim_evals.grader.properties import PROPERTIES

SLIPS: list[tuple[dict[str, Any], str]] = [
    ({"each": {"of": "robots", "has": {"radus": 0.3}}}, "radius"),
    ({"placed": {"of": "robots", "rows": [{"goalx": 0.3}]}}, "goal_x"),
    ({"distinct": {"of": "robots", "property": "colour", "number": 2}}, "color"),
    ({"states": {"of": "robots", "property": "radus", "about": "radius"}}, "radius"),
    ({"sensor": {"of": "robots", "has": {"range_mx": 4}}}, "range_max"),
    ({"world": {"widht": 10}}, "width"),
]


@pytest.mark.parametrize(("said", "meant"), SLIPS)
def test_a_misspelt_word_is_an_error_that_names_the_nearest(said: dict[str, Any], meant: str) -> None:
    with pytest.raises(ValidationError) as failure:
        Assertion.model_validate({"id": "slip", **said})
    [error] = failure.value.errors()
    assert (error["type"], error["ctx"]["fix"]) == ("unknown-value", f"write {meant}")


def test_an_expression_that_python_cannot_read_is_refused() -> None:
    for said in ({"says": {"any_of": ["(door"]}}, {"files": {"pattern": "*", "number": 1, "lack": ["(a"]}}):
        with pytest.raises(ValidationError, match="is not a regular expression"):
            Assertion.model_validate({"id": "slip", **said})


def test_every_property_has_its_sentence() -> None:
    for name, one in PROPERTIES.items():
        assert one.sentence[0].isupper() or one.sentence.startswith("``"), name
        assert one.sentence.endswith("."), name
