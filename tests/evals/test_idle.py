"""Assertions that tell nothing are reported to the author of a case."""

from __future__ import annotations

from irsim_evals.grader.artefact import Answer
from irsim_evals.proof.prove import idle_assertions
from tests.evals.conftest import RIGHT, made_up


def test_assertions_that_an_empty_world_fulfils_or_nothing_breaks_are_named() -> None:
    case = made_up(
        {"id": "robots", "count": {"of": "robots", "number": 1}},
        {"id": "nothing-else", "count": {"of": "obstacles", "number": 0}},
        {"id": "anything", "count": {"of": "all", "number": {"ge": 0}}},
    )
    reported = list(idle_assertions(case, [Answer("right", {"scenario.yaml": RIGHT})]))
    assert reported == [("nothing-else", "empty_holds"), ("anything", "empty_holds"), ("anything", "unbroken")]
