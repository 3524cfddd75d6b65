"""The page of results on recorded pedestrians says what its command computes."""

from __future__ import annotations

from pathlib import Path
from string import Formatter

import pytest

from irsim.bridges.pedestrians.published import SHA256
from tests.benchmarks.pedestrians import human, robot
from tests.benchmarks.pedestrians.write import PAGE, TEXT, with_words


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


def test_the_page_has_the_words_of_its_template() -> None:
    """Numbers take minutes, and need files that are not part of the repository; everything else is checked here."""
    shown, place = PAGE.read_text(encoding="utf-8"), 0
    for words, *_ in Formatter().parse(TEXT.read_text(encoding="utf-8")):
        place = shown.index(words, place) + len(words)
    assert place == len(shown)


def test_other_words_leave_the_tables_as_they_are() -> None:
    old, new = "Of {n} cases:\n{table}\nEnd {{x}}.", "In {n} cases\n{table}\nThe end."
    assert with_words("Of 7 cases:\n| a |\n| b |\nEnd {x}.", old, new) == "In 7 cases\n| a |\n| b |\nThe end."
    with pytest.raises(SystemExit, match="measure it again"):
        with_words("Of 7 cases: none", old, new)


def test_the_page_names_the_files_of_the_published_results() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for name, file in human.FILES.items():
        assert f"| {name} | `{file}` | {human.PUBLISHED[name]} | `{SHA256[name.lower()]}` |" in text


@pytest.mark.foreign
def test_the_table_of_files_is_made_again_and_notices_another_file(foreign: Path, tmp_path: Path) -> None:
    data = foreign / "pedestrians"
    assert human.files_table(data) in PAGE.read_text(encoding="utf-8")
    for file in human.FILES.values():
        (tmp_path / file).write_bytes((data / file).read_bytes())
    (tmp_path / human.FILES["hotel"]).write_text("0 1 0 0\n")
    assert ", not the published file |" in human.files_table(tmp_path).splitlines()[3]
    assert human.files_table(tmp_path).count("not the published file") == 1
