"""The kept results of suites: parts of them are run again, and every number must be the same."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import pytest

from irsim.benchmarks.stored import run_plan
from irsim.benchmarks.suite import SUITES
from irsim.results.benchmark import SuiteResult
from tests.benchmarks.central_planner import scene, share, succeeds
from tests.benchmarks.reference.leaderboard import PAGE, leaderboard, standings
from tests.benchmarks.reference.roles import page
from tests.benchmarks.reference.write import FOLDER, PAGES, TABLES, changes, counted, kept

GRANTED = {
    "v1": "contacts count at the ends of steps of 0.1 s only; robots change their speed at once",
    "v2": "contacts within steps count, too; accelerations are limited; ",
}
"""Version of a suite -> the beginning of what its page says is taken for granted."""


def rerun(name: str, folder: Path, seeds: int, scenarios: tuple[str, ...] | None) -> None:
    """Run the first seeds of a table again, and compare each episode with the kept one."""
    result = run_plan(TABLES[name].plan(seeds=seeds, scenarios=scenarios), folder)
    assert isinstance(result, SuiteResult)
    kept = set((FOLDER / f"{name}.csv").read_text(encoding="utf-8").splitlines())
    lines = TABLES[name].lines(result)
    assert len(lines) == len(result.scenarios) * len(result.behaviors) * seeds
    assert [line for line in lines if line not in kept] == []


def test_each_kept_file_is_of_a_table() -> None:
    assert {path.stem for path in FOLDER.glob("*.csv")} == {*TABLES}


@pytest.mark.parametrize("name", TABLES)
def test_first_episodes_are_the_kept_ones(name: str, tmp_path: Path) -> None:
    rerun(name, tmp_path / "again", 1, TABLES[name].quick)


@pytest.mark.slow(15)
@pytest.mark.parametrize("name", TABLES)
def test_many_episodes_are_the_kept_ones(name: str, tmp_path: Path) -> None:
    rerun(name, tmp_path / "again", 12, TABLES[name].again)


def test_the_page_of_mixed_populations_is_that_of_its_episodes() -> None:
    for name in (name for name, table in TABLES.items() if table.by_role):
        with (FOLDER / f"{name}.csv").open(encoding="utf-8") as file:
            text = page(list(csv.DictReader(file)), TABLES[name].plan()) + f"{kept(name)}\n"
        assert (PAGES / f"{name}.md").read_text(encoding="utf-8") == text


def test_the_leaderboard_is_that_of_the_kept_episodes() -> None:
    assert PAGE.read_text(encoding="utf-8") == leaderboard()


def test_a_policy_leads_for_sure_only_if_its_pairs_say_so() -> None:
    def lines(policy: str, failures: int) -> list[dict[str, str]]:
        outcomes = ["collision"] * failures + ["success"] * (40 - failures)
        pairs = zip(range(40), outcomes, strict=True)
        return [{"scenario": f"a{n % 4}", "seed": str(n), "policy": policy, "outcome": one} for n, one in pairs]

    clear = standings([*lines("worse", 30), *lines("best", 0)])
    assert [one.policy for one in clear] == ["best", "worse"]
    assert clear[1].shares == (0.25, 0.75, 0.0)
    assert clear[1].behind == -0.75
    assert -0.9 < clear[1].behind_interval[0] < -0.75 < clear[1].behind_interval[1] < -0.5
    close = standings([*lines("worse", 1), *lines("best", 0)])
    assert close[1].behind_interval[0] < close[1].behind < 0.0 < close[1].behind_interval[1]


@pytest.mark.parametrize("name", [name for name, table in TABLES.items() if not table.by_role])
def test_the_table_counts_the_kept_episodes(name: str) -> None:
    page = (PAGES / f"{name}.md").read_text(encoding="utf-8")
    assert TABLES[name].suite in SUITES.names()
    plan = TABLES[name].plan()
    assert f"suite hash {plan.suite_hash}, run hash {plan.hash}, " in page
    with (FOLDER / f"{name}.csv").open(encoding="utf-8") as file:
        outcomes = counted(csv.DictReader(file))
    for (scenario, policy), count in outcomes.items():
        shares, *_ = re.findall(rf"^\| {re.escape(scenario)} \| {re.escape(policy)} \| (.*)$", page, re.MULTILINE)
        cells = shares.split(" | ")
        n = int(cells[0])
        shown = [int(cell.split("%")[0]) for cell in cells[1:4]]
        placed = sum(count.values()) - count["placement-crowded"]
        wanted = [float(f"{100 * count[name] / n:.0f}") for name in ("success", "collision", "timeout")]
        assert (n, shown) == (placed, wanted), (scenario, policy)
    assert page.endswith("\n" + "\n".join([*changes(name, outcomes), kept(name), ""]))
    assert f"Taken for granted: {GRANTED[TABLES[name].suite[-2:]]}" in page


def test_the_central_planner_solves_a_few_scenes() -> None:
    solved, unsolved = share(10, range(100, 104))
    assert sorted(solved) == [100, 101, 102, 103]
    assert unsolved == []


def test_a_robot_that_never_sets_off_does_not_arrive() -> None:
    text = scene(5)
    assert succeeds(text, 100, [0] * 5, 500)
    assert not succeeds(text, 100, [0, 0, 0, 0, 500], 500)
