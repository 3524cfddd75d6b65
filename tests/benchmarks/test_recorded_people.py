"""The page of results on recorded pedestrians says what its command computes."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.benchmarks.pedestrians import human, robot
from tests.benchmarks.pedestrians.write import PAGE


@pytest.mark.foreign
def test_the_cells_of_hotel_are_derived_again(foreign: Path) -> None:
    compared = human.compare(foreign / "pedestrians", ["hotel"])
    assert "\n".join(human.table(compared, "hotel")) in PAGE.read_text(encoding="utf-8")


def test_the_page_has_a_table_for_each_recording() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert [name for name in human.FILES if f"**{name}**: " not in text] == []


@pytest.mark.foreign
def test_the_suite_is_written_again_and_its_first_episodes_are_those_on_record(foreign: Path) -> None:
    plan = robot.plan_of(foreign / "pedestrians")
    assert f"hash {plan.suite_hash}." in PAGE.read_text(encoding="utf-8")
    assert robot.episodes(plan) == robot.EPISODES.read_text(encoding="utf-8").splitlines()
