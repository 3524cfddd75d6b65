"""The published list of differences: complete, and the one that the tests read."""

import re

import pytest

from irsim.compatibility import DIFFERENCES, KEY_DIFFERENCES, NAME_DIFFERENCES, reference_names
from irsim.lookup import lookup
from tests.parity import differences as of_traces

_IDS = re.compile(r"[\w-]+")


def test_traces_name_published_ids() -> None:
    assert set(of_traces.DIFFERENCES) <= set(DIFFERENCES)


@pytest.mark.parametrize("table", [KEY_DIFFERENCES, NAME_DIFFERENCES])
def test_ids_that_are_named_exist(table: dict[str, str]) -> None:
    assert {name for ids in table.values() for name in _IDS.findall(ids)} <= set(DIFFERENCES)


def test_names_that_differ_exist() -> None:
    owners = {place.partition(":")[2]: names for place, names in reference_names().items()}
    for place in NAME_DIFFERENCES:
        owner, _, name = place.rpartition(".")
        assert name in owners[owner], place


def test_ids_can_be_looked_up() -> None:
    assert lookup("D6").text.startswith("IR-SIM 2.12: polygons and maps")
