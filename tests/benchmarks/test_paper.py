"""The page on the policies of the IR-SIM paper has the tables of the episodes that are kept."""

from __future__ import annotations

from pathlib import Path

import pytest

from irsim.policies.rl_rvo_authors import VARIABLE
from tests.benchmarks.paper import runs, tables
from tests.benchmarks.paper.__main__ import PAGE, from_kept, main, unlike
from tests.benchmarks.reference.kept import source_of


def test_the_tables_of_the_page_are_those_of_the_kept_episodes() -> None:
    page = PAGE.read_text(encoding="utf-8")
    made = from_kept()
    assert {*made} == {*tables.CELLS_OF}
    assert tables.on_page(page, "source") == source_of(runs.FULL)
    for name, table in made.items():
        assert tables.on_page(page, name) == table


def test_the_check_says_of_each_cell_whether_it_is_equal(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--check"]) == 0
    shown = capsys.readouterr().out
    assert "shares: freeze, `orca`, 25 robots: 23/26/51: equal\n" in shown
    assert "beside: 10, RL-RVO, here, yield: 98/1/1, 6.49 s, 0.77, 4.95: equal\n" in shown
    assert "authors: 5, RL-RVO, authors' weights: 88/7/5 (success 78 to 94), 0.72 m/s: equal\n" in shown
    assert "circle: 14, 0.1 m, right turns limited: 21/79/0: equal\n" in shown
    assert "\n138 equal, 0 differ\n" in shown


def test_another_number_on_the_page_is_named() -> None:
    page, table = PAGE.read_text(encoding="utf-8"), from_kept()["shares"]
    other = tables.put_on_page(page, "shares", table.replace("86/4/10", "87/4/9", 1))
    assert tables.on_page(other, "shares") != table
    assert other.replace("87/4/9", "86/4/10") == page
    assert [line for line in unlike(other, "shares", table) if not line.endswith(": equal")] == [
        "shares: freeze, `orca`, 10: 86/4/10: differs, the page has 87/4/9"
    ]


def test_the_first_of_1000_episodes_are_those_of_the_other_tables() -> None:
    columns = ("scenario", "policy", "seed", "outcome", "steps")
    known = {tuple(row[key] for key in columns) for row in runs.kept_table_2()}
    many = [tuple(row[key] for key in columns) for row in runs.kept_full()]
    shared = [row for row in many if int(row[2]) < 200]
    assert len(many) == 34_000
    assert len(shared) == 3_400
    assert {*shared} <= known


@pytest.mark.slow(60)
def test_some_of_the_1000_episodes_are_run_again() -> None:
    again = runs.full(lambda text: None, range(600, 606))
    known = {(row["scenario"], row["policy"], row["seed"]): row["outcome"] + row["steps"] for row in runs.kept_full()}
    assert len(again) == 6 * (6 * 4 + 10)
    for row in again:
        assert known[row["scenario"], row["policy"], row["seed"]] == row["outcome"] + row["steps"]


@pytest.mark.foreign
def test_first_episodes_of_the_authors_weights_are_the_kept_ones(
    foreign: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, str(foreign / "policies" / "rl_rvo_pre_train.pt"))
    kept = runs.kept(runs.AUTHORS)
    again = runs.authors(2)
    assert len(again) == 4
    assert [row for row in again if row not in kept] == []
