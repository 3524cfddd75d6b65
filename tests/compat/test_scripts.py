"""Scripts of users, unmodified: each prints what it printed with PyPI's ir-sim 2.12.0."""

from __future__ import annotations

import sys

import pytest

from irsim.compat import DIFFERENCES
from tests.compat.scripts import NAMES, play, recorded, same
from tests.warm import warm

pytestmark = pytest.mark.one_python

KNOWN: dict[str, dict[str, str]] = {
    "avoidance_functions": {"wall": "D6"},  # a line met after half the look ahead does not count
    "shapes": {"sizes": "D2"},  # radius of the compound, whose round part is a 64-gon there
}
"""Facts that differ on purpose: script -> fact -> the id in :data:`irsim.compat.DIFFERENCES`."""


def _name(fact: str) -> str:
    return fact.removeprefix(">> ").partition(" = ")[0]


@pytest.mark.parametrize("name", NAMES)
def test_a_script_prints_what_it_printed(name: str) -> None:
    facts, complaint = play(name, sys.executable, warm)
    assert complaint == ""
    expected = recorded(name)
    assert [_name(fact) for fact in facts] == [_name(fact) for fact in expected]
    differ = [(ours, theirs) for ours, theirs in zip(facts, expected, strict=True) if not same(ours, theirs)]
    assert [pair for pair in differ if _name(pair[0]) not in KNOWN.get(name, {})] == []
    assert {_name(ours) for ours, _ in differ} == set(KNOWN.get(name, {}))


def test_differences_have_a_published_id() -> None:
    assert {number for facts in KNOWN.values() for number in facts.values()} <= set(DIFFERENCES)
    assert set(KNOWN) <= set(NAMES)
