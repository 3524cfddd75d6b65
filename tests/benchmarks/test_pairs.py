"""Rows over several scenarios, every pair of policies and their ranks: what they say when scenarios are unlike."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

import irsim
from irsim.benchmarks.pairs import pairs_of, ranks_of
from irsim.benchmarks.stored import measure_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.benchmarks.summary import KEYS, rows_of, summaries_of
from irsim.metrics import mcnemar, newcombe, wilson
from irsim.results.benchmark import EpisodeRow

LAYOUTS = [f"layout-{number}" for number in range(10)]
SEEDS = 10
CHANCE = {layout: ["seed"] for layout in LAYOUTS}


def episode(scenario: str, behavior: str, seed: int, *, success: bool) -> EpisodeRow:
    known = {"success": float(success), "collision": float(not success), "timeout": 0.0}
    known |= {"collision_count": float(not success), "driving_time": 10.0 if success else 5.0}
    return EpisodeRow(
        scenario=scenario, behavior=behavior, seed=seed, outcome="success" if success else "collision", steps=1,
        sim_time=1.0, time_limit=1.0, unreachable=0, failures={}, metrics={key: known.get(key) for key in KEYS},
    )  # fmt: skip


def benchmark(successes: dict[str, list[int]]) -> list[EpisodeRow]:
    """Episodes of behaviors that succeed in the first so many seeds of each layout."""
    return [
        episode(layout, behavior, seed, success=seed < count)
        for behavior, counts in successes.items()
        for layout, count in zip(LAYOUTS, counts, strict=True)
        for seed in range(SEEDS)
    ]


def test_a_row_over_layouts_of_unlike_difficulty_has_a_wider_interval_than_its_episodes() -> None:
    """All failures of one behavior are in two layouts: its episodes say little about other layouts."""
    names = ["sure", "wedged"]
    episodes = benchmark({"sure": [10] * 10, "wedged": [0, 0, *[10] * 8]})
    summaries = summaries_of(episodes, LAYOUTS, names)
    [_, row] = rows_of(summaries, names, CHANCE, {})[-2:]
    assert (row.scenario, row.success.rate) == ("(all)", 0.8)
    low, high = wilson(80, 100)
    assert row.success.low is not None
    assert row.success.high is not None
    assert row.success.low == pytest.approx(0.5, abs=0.06)  # 5 of 10 layouts are wedged in one of 40 draws
    assert row.success.high >= high
    assert row.success.low < low - 0.1
    assert (row.metrics["success"].low, row.metrics["success"].high) == (row.success.low, row.success.high)
    paired, alone = row.paired["success"], newcombe(80, 0, 20, 0)
    assert paired.mean == pytest.approx(-0.2)
    assert paired.low is not None
    assert paired.low < alone[0] - 0.1


def test_a_pair_has_the_interval_of_its_row_in_whatever_order_scenarios_are() -> None:
    names, counts = ["first", "second"], {"first": [10] * 10, "second": [0, 2, 9, 10, 4, 10, 7, 10, 1, 10]}
    episodes = benchmark(counts)
    back = LAYOUTS[::-1]
    turned = sorted(episodes, key=lambda one: back.index(one.scenario))
    for order, made in ((LAYOUTS, episodes), (back, turned)):
        summaries = summaries_of(made, order, names)
        row = rows_of(summaries, names, CHANCE, {})[-1]
        pair = next(one for one in pairs_of(summaries, names, CHANCE, {}) if one.scenario == "(all)")
        apart, paired = pair.difference, row.paired["success"]
        assert (apart.low, apart.high) == pytest.approx((-(paired.high or 0), -(paired.low or 0)), abs=1e-12)


def test_layouts_that_are_alike_have_the_interval_of_independent_episodes() -> None:
    episodes = benchmark({"even": [8] * 10})
    [row] = rows_of(summaries_of(episodes, LAYOUTS, ["even"]), ["even"], CHANCE, {})[-1:]
    assert (row.success.low, row.success.high) == pytest.approx(wilson(80, 100), abs=0.02)
    certain = benchmark({"even": [10] * 10})
    [row] = rows_of(summaries_of(certain, LAYOUTS, ["even"]), ["even"], CHANCE, {})[-1:]
    assert (row.success.low, row.success.high) == wilson(100, 100)  # never narrower


def test_equal_episodes_of_a_policy_that_nothing_random_reaches_count_once() -> None:
    """`same` succeeds in 9 of 10 layouts, with every seed alike; `fails` draws, and fails with each draw alike."""
    names = ["same", "fails", "twin"]
    episodes = benchmark({"same": [0, *[10] * 9], "fails": [0] * 10, "twin": [10] * 10})
    certain = {layout: ["same", "twin"] for layout in LAYOUTS}
    summaries = summaries_of(episodes, LAYOUTS, names)
    rows = {(row.scenario, row.behavior): row for row in rows_of(summaries, names, CHANCE, certain)}
    assert [rows["(all)", name].episodes for name in names] == [10, 100, 10]
    alone, over_all = rows["layout-3", "same"], rows["(all)", "same"]
    assert (alone.episodes, alone.success.rate, alone.success.low) == (1, 1.0, None)
    assert (rows["layout-3", "fails"].episodes, rows["layout-3", "fails"].success.high) == (10, wilson(0, 10)[1])
    assert over_all.success.rate == 0.9
    assert over_all.success.low is not None
    assert over_all.success.low <= wilson(9, 10)[0]
    assert rows["layout-3", "twin"].paired["success"].n == 1
    assert rows["layout-3", "fails"].paired["success"].n == 10
    pairs = pairs_of(summaries, names, CHANCE, certain)
    twins = {one.scenario: one for one in pairs if (one.behavior, one.against) == ("same", "twin")}
    assert (twins["layout-0"].difference.mean, twins["layout-0"].difference.low, twins["layout-0"].p) == (
        -1,
        None,
        None,
    )
    assert (twins["(all)"].difference.n, twins["(all)"].only_against) == (10, 1)
    ranks = {(one.scenario, one.behavior): one for one in ranks_of(list(rows.values()), pairs)}
    assert (ranks["layout-0", "twin"].low, ranks["layout-0", "twin"].high) == (1, 1)  # exact, so no place is open


def test_episodes_that_differ_count_all_though_nothing_random_is_known() -> None:
    episodes = benchmark({"some": [6] * 10})
    certain = {layout: ["some"] for layout in LAYOUTS}
    [*_, row] = rows_of(summaries_of(episodes, LAYOUTS, ["some"]), ["some"], CHANCE, certain)
    assert (row.episodes, row.success.rate) == (100, 0.6)


def test_contacts_per_hour_are_all_contacts_over_all_hours() -> None:
    [row] = rows_of(summaries_of(benchmark({"some": [6] * 10}), LAYOUTS, ["some"]), ["some"], CHANCE, {})[-1:]
    contacts = row.metrics["contacts_per_hour"]
    assert contacts.mean == pytest.approx(3600 * 40 / (60 * 10 + 40 * 5))
    assert contacts.low is not None
    assert contacts.high is not None
    assert 90 < contacts.low < contacts.mean < contacts.high < 280


def test_every_pair_of_policies_is_compared() -> None:
    names = ["best", "middle", "worst"]
    episodes = benchmark({"best": [10] * 10, "middle": [7] * 10, "worst": [0] * 10})
    summaries = summaries_of(episodes, LAYOUTS, names)
    pairs = {
        (one.behavior, one.against): one for one in pairs_of(summaries, names, CHANCE, {}) if one.scenario == "layout-3"
    }
    assert list(pairs) == [("best", "middle"), ("best", "worst"), ("middle", "worst")]
    pair = pairs["middle", "worst"]
    assert (pair.difference.mean, pair.difference.n) == (pytest.approx(0.7), 10)
    assert (pair.only_behavior, pair.only_against, pair.p) == (7, 0, pytest.approx(2 / 2**7))
    assert pairs["best", "middle"].p == pytest.approx(0.25)  # three pairs cannot tell
    over_all = [one for one in pairs_of(summaries, names, CHANCE, {}) if one.scenario == "(all)"]
    assert [one.p for one in over_all] == [None, None, None]  # its episodes are not independent


def test_ranks_say_which_places_are_open() -> None:
    names = ["good", "like", "bad"]
    episodes = benchmark({"good": [9] * 10, "like": [9] * 10, "bad": [2] * 10})
    summaries = summaries_of(episodes, LAYOUTS, names)
    pairs = pairs_of(summaries, names, CHANCE, {})
    ranks = {
        one.behavior: one for one in ranks_of(rows_of(summaries, names, CHANCE, {}), pairs) if one.scenario == "(all)"
    }
    assert [(ranks[name].rank, ranks[name].low, ranks[name].high) for name in names] == [
        (1.5, 1, 2), (1.5, 1, 2), (3, 3, 3),
    ]  # fmt: skip


def test_mcnemar_exact() -> None:
    assert mcnemar(0, 0) == mcnemar(3, 3) == 1.0
    assert mcnemar(1, 5) == mcnemar(5, 1) == pytest.approx(14 / 64)
    assert mcnemar(10, 0) == pytest.approx(2 / 1024)


def test_scenarios_with_a_tag_have_a_row_of_their_own(tmp_path: Path) -> None:
    scenarios = [
        {"name": name, "template": "crossing", "parameters": {"courier_speed": speed}, "tags": tags}
        for name, speed, tags in (("slow", 0.5, ["calm"]), ("middle", 0.7, ["calm"]), ("fast", 0.9, []))
    ]
    file = tmp_path / "mine.yaml"
    told = {
        "suite": "mine", "version": 1, "title": "Mine", "steps": 20, "policies": {"dash": "dash", "rvo": "rvo"},
        "seeds": {"count": 2}, "scenarios": scenarios, "protocols": ["freeze", "yield"],
        "perturb": [{"position": 0.1}],
    }  # fmt: skip
    file.write_text(yaml.safe_dump(told), encoding="utf-8")
    result = measure_plan(suite_plan(str(file)), workers=1)
    assert result.groups == {"calm": ["slow/freeze", "slow/yield", "middle/freeze", "middle/yield"]}
    summaries = [row.scenario for row in result.rows if row.scenario.startswith("(") and row.behavior == "dash"]
    assert summaries == ["(all)/freeze", "(all)/yield", "(all calm)/freeze", "(all calm)/yield"]
    assert {row.episodes for row in result.rows if row.scenario == "(all calm)/freeze"} == {4}


def test_time_of_all_counts_the_horizon_for_who_never_arrived(tmp_path: Path) -> None:
    file = tmp_path / "two.yaml"
    file.write_text(
        "world: {width: 20, height: 6, time_limit: 8}\nrobot:\n"
        "  - {kinematics: {name: omni}, state: [1, 1], goal: [4, 1], vel_max: [1, 1], behavior: {name: dash}}\n"
        "  - {kinematics: {name: omni}, state: [1, 4], goal: [19, 4], vel_max: [1, 1], behavior: {name: dash}}\n"
    )
    [one] = irsim.benchmark(file, seeds=1).episodes
    first = one.metrics["time_to_goal"]
    assert first is not None
    assert one.metrics["restricted_time"] == pytest.approx((first + 8) / 2)
    assert one.metrics["driving_time"] == pytest.approx((first + 8) / 2)
    assert (one.metrics["arrived_share"], one.metrics["goal_reached"], one.metrics["contacts_per_hour"]) == (0.5, 0, 0)
