"""The kept results of suites: parts of them are run again, and every number must be the same."""

from __future__ import annotations

import re
from pathlib import Path
from typing import cast

import pytest

from irsim.benchmarks.stored import run_plan
from irsim.benchmarks.suite import SUITES
from irsim.results.benchmark import EpisodeRow, SuiteResult
from tests.benchmarks.central_planner import scene, share, succeeds
from tests.benchmarks.paper import runs
from tests.benchmarks.pedestrians import robot, walks
from tests.benchmarks.reference import kept, write
from tests.benchmarks.reference.kept import FOLDER, episode_of, is_kept, is_whole, kept_lines, source_of
from tests.benchmarks.reference.leaderboard import (
    LEFT_OUT,
    LEFT_OUT_OF_SUITES,
    PAGE,
    certain_of,
    leaderboard,
    standings,
    unlisted_policies,
)
from tests.benchmarks.reference.write import (
    ONE_ROBOT,
    PAGES,
    TABLES,
    Table,
    changed_lines,
    changes,
    counted,
    episodes_of,
    kept_of,
    page_of,
)

GRANTED = {
    "v1": "contacts count at the ends of steps of 0.1 s only; robots change their speed at once",
    "v2": "contacts within steps count, too; accelerations are limited; ",
    "noisy": "contacts within steps count, too; accelerations are limited, and commands pass actuators (delay, lag); "
    "robots know where they are from an estimate and others from tracks of a detector.",
}
"""Last word of a suite's name -> the beginning of what its page says is taken for granted."""


WHOLE = [name for name, table in TABLES.items() if is_kept(name) and (table.by_role or is_whole(kept_lines(name)[0]))]
"""Tables whose pages are made from their lines."""


def rerun(name: str, folder: Path, seeds: int, scenarios: tuple[str, ...] | None) -> None:
    """Run the first seeds of a table again, and compare each episode with the kept one."""
    seeds = min(seeds, TABLES[name].seeds or seeds)
    result = run_plan(TABLES[name].plan(seeds=seeds, scenarios=scenarios), folder)
    assert isinstance(result, SuiteResult)
    lines = TABLES[name].lines(result)
    assert len(lines) == len(result.scenarios) * len(result.behaviors) * seeds
    assert changed_lines(name, lines) == []


def test_each_kept_file_is_of_a_table_and_has_all_its_episodes() -> None:
    others = {runs.FULL, robot.KEPT, walks.KEPT}  # pages with commands of their own
    assert {path.name for path in FOLDER.glob("*.csv*")} == {f"{name}.csv.gz" for name in {*TABLES, *others}}
    for name, table in TABLES.items():
        plan = table.plan()
        assert len(kept_of(name)) == len(plan.scenarios) * len(plan.policies) * len(plan.seeds) == len(kept_lines(name))


SMALL = """\
suite: small
version: 1
title: Two robots swap places
scenarios: [{name: pair, template: circle-swap, parameters: {robots: 2}}]
seeds: {first: 0, count: 2}
steps: 60
policies: {orca: orca, dash: dash}
"""


def test_kept_episodes_are_used_again_unless_they_are_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "tests" / "benchmarks" / "reference"
    folder.mkdir(parents=True)
    (tmp_path / "small.yaml").write_text(SMALL, encoding="utf-8")
    for module in (kept, write):
        monkeypatch.setattr(module, "FOLDER", folder)
    monkeypatch.setattr(write, "PAGES", tmp_path)

    def keep(*policies: str, again: bool = False) -> list[tuple[str, str]]:
        monkeypatch.setitem(TABLES, "small", Table(str(tmp_path / "small.yaml"), ("pair",), policies))
        write.main("small", again=again)
        return [(line["policy"], line["path_length"]) for line in kept_lines("small")]

    first = keep("orca")
    assert keep("orca", "dash")[: len(first)] == first
    lines = kept_lines("small")
    kept.write("small", list(lines[0]), [line | {"path_length": "1.0"} for line in lines])
    with pytest.raises(SystemExit, match=r"pair, orca, seed 0: path_length .*, kept 1\.0"):
        keep("orca", "dash")
    assert keep("orca", "dash", again=True)[: len(first)] == first


@pytest.mark.parametrize("name", TABLES)
def test_first_episodes_are_the_kept_ones(name: str, tmp_path: Path) -> None:
    rerun(name, tmp_path / "again", 1, TABLES[name].quick)


@pytest.mark.slow(15)
@pytest.mark.parametrize("name", TABLES)
def test_many_episodes_are_the_kept_ones(name: str, tmp_path: Path) -> None:
    rerun(name, tmp_path / "again", 12, TABLES[name].again)


@pytest.mark.parametrize("name", [name for name in WHOLE if name in ("mixed_v2", "maps_v2")])
def test_a_page_is_made_from_the_kept_episodes(name: str) -> None:
    assert (PAGES / f"{name}.md").read_text(encoding="utf-8") == page_of(name)


@pytest.mark.slow(15)
@pytest.mark.parametrize("name", [name for name in WHOLE if name not in ("mixed_v2", "maps_v2")])
def test_a_large_page_is_made_from_the_kept_episodes(name: str) -> None:
    assert (PAGES / f"{name}.md").read_text(encoding="utf-8") == page_of(name)


def test_copies_of_an_episode_are_one_on_the_page_of_maps() -> None:
    certain, policies = certain_of("maps_v2"), TABLES["maps_v2"].plan().policies
    assert {text for own in certain.values() for text in own} == {policies["astar"], policies["jps"]}
    known, first_seed = kept_of("maps_v2"), TABLES["maps_v2"].plan().seeds[0]
    for (scenario, policy, seed), line in known.items():
        first = known[scenario, policy, first_seed]
        if policies[policy] in certain[scenario]:
            assert line == first | {"seed": str(seed)}, (scenario, policy, seed)
    page = (PAGES / "maps_v2.md").read_text(encoding="utf-8")
    assert "| maze/freeze | astar | 1 | 100% | 0% | 0% | 56.10 |" in page
    assert "| (all) | astar | 16 | 94% (72% to 100%) |" in page
    assert "| maze/freeze | rrt_star | 10 | 0% (0% to 28%) |" in page


@pytest.mark.parametrize("name", [name for name, table in TABLES.items() if table.protocols == ("freeze",)])
def test_both_protocols_give_one_robot_equal_episodes(name: str, tmp_path: Path) -> None:
    plan = TABLES[name].plan(seeds=1, scenarios=TABLES[name].quick, protocols=None)
    lines = TABLES[name].lines(cast(SuiteResult, run_plan(plan, tmp_path / "both")))
    rows = [{**line, "scenario": line["scenario"].rpartition("/")[0]} for line in lines]
    half = len(rows) // 2
    assert [line["scenario"].rpartition("/")[2] for line in lines] == ["freeze"] * half + ["yield"] * half
    assert rows[:half] == rows[half:]
    assert ONE_ROBOT in (PAGES / f"{name}.md").read_text(encoding="utf-8")


def test_the_leaderboard_is_that_of_the_kept_episodes() -> None:
    assert PAGE.read_text(encoding="utf-8") == leaderboard()


def test_the_leaderboard_has_the_shares_and_intervals_of_the_page_of_a_suite() -> None:
    page = (PAGES / "circle_swap_v2.md").read_text(encoding="utf-8")
    freeze = [one for one in episodes_of("circle_swap_v2") if one.scenario.endswith("/freeze")]
    for one in standings(freeze, TABLES["circle_swap_v2"].plan().policies, certain_of("circle_swap_v2")):
        share = one.shares[0]
        cell, *_ = re.findall(
            rf"^\| \(all\)/freeze \| {one.policy} \| {one.episodes} \| ([^|]*) \|", page, re.MULTILINE
        )
        shown = [float(text) for text in re.findall(r"([\d.]+)%", cell)]
        assert shown == pytest.approx([100 * (value or 0) for value in (share.rate, share.low, share.high)], abs=0.51)


def test_each_policy_is_in_a_table_or_left_out_for_a_reason() -> None:
    everywhere, of_suites = unlisted_policies()
    assert everywhere == {*LEFT_OUT}
    assert of_suites == {*LEFT_OUT_OF_SUITES}


def test_a_policy_leads_for_sure_only_if_its_pairs_say_so() -> None:
    def episodes(policy: str, failures: int) -> list[EpisodeRow]:
        outcomes = ["collision"] * failures + ["success"] * (40 - failures)
        pairs = zip(range(40), outcomes, strict=True)
        lines = [{"scenario": f"a{n % 4}", "seed": str(n), "outcome": one} for n, one in pairs]
        return [episode_of(line, policy) for line in lines]

    policies = {"worse": "orca", "best": "footprint_orca"}
    clear = standings([*episodes("orca", 30), *episodes("footprint_orca", 0)], policies, {})
    assert [(one.policy, one.knows) for one in clear] == [("best", "outlines+intent"), ("worse", "circles+intent")]
    assert [share.rate for share in clear[1].shares] == [0.25, 0.75, 0.0]
    assert clear[0].behind is None
    lead = clear[1].behind
    assert lead is not None
    assert lead.mean == -0.75
    assert -0.9 < (lead.low or 0) < -0.75 < (lead.high or 0) < -0.5
    lead = standings([*episodes("orca", 1), *episodes("footprint_orca", 0)], policies, {})[1].behind
    assert lead is not None
    assert (lead.low or 0) < (lead.mean or 0) < 0.0 < (lead.high or 0)


@pytest.mark.parametrize("name", [name for name, table in TABLES.items() if not table.by_role])
def test_the_table_counts_the_kept_episodes(name: str) -> None:
    page = (PAGES / f"{name}.md").read_text(encoding="utf-8")
    assert TABLES[name].suite in SUITES.names()
    plan = TABLES[name].plan()
    assert f"suite hash {plan.suite_hash}, run hash {plan.hash}, " in page
    outcomes, certain = counted(kept_lines(name)), certain_of(name)
    for (scenario, policy), count in outcomes.items():
        shares, *_ = re.findall(rf"^\| {re.escape(scenario)} \| {re.escape(policy)} \| (.*)$", page, re.MULTILINE)
        cells = shares.split(" | ")
        n = int(cells[0])
        shown = [float(cell.split("%")[0]) for cell in cells[1:4]]
        placed = sum(count.values()) - count["placement-crowded"]
        wanted = [100 * count[name] / placed for name in ("success", "collision", "timeout")]
        once = plan.policies[policy] in certain.get(scenario, ())
        assert n == (1 if once else placed), (scenario, policy)
        assert shown == pytest.approx(wanted, abs=0.51), (scenario, policy)
        assert ("(" in cells[1]) != once, (scenario, policy)
    assert page.endswith("\n" + "\n".join([*changes(name, outcomes), source_of(name), ""]))
    assert f"Taken for granted: {GRANTED[TABLES[name].suite.rpartition('_')[2]]}" in page


def test_the_central_planner_solves_a_few_scenes() -> None:
    solved, unsolved = share(10, range(100, 104))
    assert sorted(solved) == [100, 101, 102, 103]
    assert unsolved == []


def test_a_robot_that_never_sets_off_does_not_arrive() -> None:
    text = scene(5)
    assert succeeds(text, 100, [0] * 5, 500)
    assert not succeeds(text, 100, [0, 0, 0, 0, 500], 500)
