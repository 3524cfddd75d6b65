"""One idea has one home: how often each kind of code may be there. Totals of lines and files are only printed."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from tests.packaging import house


@pytest.mark.parametrize(
    ("find", "most"),
    [
        (house.object_types, 9),
        (house.part_loops, 1),
        (house.process_limits, 1),
        (house.process_starts, 7),
        (house.child_protocols, 3),
        (house.problem_types, 5),
        (house.translators, 1),
        (house.hashes, 1),
        (house.limited_reads, 1),
        (house.schema_versions, 1),
    ],
)
def test_one_idea_has_one_home(find: Callable[[], list[str]], most: int) -> None:
    assert len(find()) <= most, find()


def test_markers_choose_the_tests_of_a_session() -> None:
    """Only the tests under sanitizers are the tests of a folder."""
    assert re.findall(r"tests/[\w/.]+", (house.ROOT / "noxfile.py").read_text(encoding="utf-8")) == ["tests/core"]


def test_tests_that_do_more_at_night_run_at_night() -> None:
    texts = {path: path.read_text(encoding="utf-8") for path in (house.ROOT / "tests").rglob("test_*.py")}
    reading = {path: text for path, text in texts.items() if re.search(r"environ.*IRSIM_NIGHTLY", text)}
    assert [str(path) for path, text in reading.items() if "mark.nightly" not in text] == []
    assert len(reading) >= 5


def test_imports_inside_functions_are_few() -> None:
    assert house.function_imports() <= 200


@pytest.mark.parametrize(
    ("name", "most"), [("changes of box", 110), ("changes of room", 216), ("names of a robot", 65)]
)
def test_a_recorded_run_goes_straight(name: str, most: int) -> None:
    assert house.run_of_one()[name] <= most
