"""Ranks with ideal and with realistic sensing: the page follows from kept episodes of the same scenes and seeds."""

from __future__ import annotations

import math

import pytest

from irsim.benchmarks.episode import environment_of
from irsim.benchmarks.stored import prepare_plan
from irsim.results.benchmark import EpisodeRow
from tests.benchmarks.reference.kept import episode_of
from tests.benchmarks.reference.realistic_ranks import (
    PAGE,
    compare,
    comparisons,
    kendall,
    realistic_ranks,
    section,
    twins,
)
from tests.benchmarks.reference.write import PAGES, TABLES, kept_of

POLICIES = {"exact": "orca", "robust": "footprint_orca", "blind": "dash"}


def episodes(failures: dict[str, int], *, in_belief: bool = False) -> list[EpisodeRow]:
    """40 episodes of each policy in four scenarios, the first of which fail; ``in_belief``: not for the robots."""
    made = []
    for policy, number in failures.items():
        for n in range(40):
            line = {"scenario": f"a{n % 4}", "seed": str(n), "outcome": "timeout" if n < number else "success"}
            line |= {"success_in_belief": "1.0"} if in_belief else {"min_clearance": str(n / 100)}
            made.append(episode_of(line, POLICIES[policy]))
    return made


def test_policies_change_places_for_sure_only_if_both_sides_say_so() -> None:
    ideal = episodes({"exact": 0, "robust": 12, "blind": 38})
    for lost, surely in ((30, [("robust", "exact")]), (13, [])):
        realistic = episodes({"exact": lost, "robust": 12, "blind": 38}, in_belief=True)
        made = compare(ideal, realistic, POLICIES)
        assert [one.policy for one in made.changes] == ["robust", "exact", "blind"]
        assert [tuple(rank.rank for rank in one.ranks) for one in made.changes] == [(2, 1), (1, 2), (3, 3)]
        assert (made.pairs, made.swapped, made.surely) == (3, [("robust", "exact")], surely)
        assert (made.parted, made.level) == (0, 0 if surely else 1)
        assert made.tau == pytest.approx(1 / 3)  # two pairs of three keep their order
        same, changed, _ = made.changes
        assert (same.difference.mean, changed.difference.mean) == (0.0, -lost / 40)
        assert (changed.in_belief, changed.clearance) == (1.0, pytest.approx(0.195))
        assert (changed.difference.low or 0.0) < -lost / 40 < (changed.difference.high or 0.0) < 0.05
        assert (same.difference.low or 0.0) < 0.0 < (same.difference.high or 0.0)


def test_kendalls_correlation_counts_ties() -> None:
    assert kendall([1, 2, 3, 4], [10, 20, 30, 40]) == 1.0
    assert kendall([1, 2, 3, 4], [4, 3, 2, 1]) == -1.0
    # five pairs differ on one side and five on the other, four in the same direction on both
    assert kendall([1, 1, 2, 3], [1, 2, 3, 3]) == pytest.approx(4 / 5)
    assert math.isnan(kendall([1, 1], [1, 2]))


@pytest.mark.parametrize("name", twins())
def test_both_kinds_of_sensing_have_the_same_trials(name: str) -> None:
    ideal, realistic = kept_of(name.removesuffix("_noisy")), kept_of(name)
    crowded = {key for key, line in realistic.items() if line["outcome"] == "placement-crowded"}
    assert crowded == {key for key in realistic if ideal[key]["outcome"] == "placement-crowded"}
    assert {line["time_limit"] for line in realistic.values()} == {ideal[key]["time_limit"] for key in realistic}


@pytest.mark.parametrize("name", twins())
def test_both_kinds_of_sensing_start_alike(name: str) -> None:
    starts = []
    for table in (name.removesuffix("_noisy"), name):
        plan = TABLES[table].plan(seeds=1, scenarios=TABLES[name].quick, policies=("orca",))
        [task] = [task for _, _, task in prepare_plan(plan).plan][:1]
        env = environment_of(task.job, task.seed)
        starts.append(
            [(one.name, *one.state.ravel(), *(() if one.goal is None else one.goal.ravel())) for one in env.objects]
        )
        env.end(ending_time=0.0)
    assert starts[0] == starts[1]


def test_a_part_of_the_page_is_that_of_the_kept_episodes() -> None:
    assert section("clutter_v2_noisy", comparisons("clutter_v2_noisy")) in PAGE.read_text(encoding="utf-8")


@pytest.mark.slow(15)
def test_the_page_is_that_of_the_kept_episodes() -> None:
    assert PAGE.read_text(encoding="utf-8") == realistic_ranks()


def test_the_page_is_linked_where_readers_look() -> None:
    for page in ("results.md", "realism.md", "../SKILL.md"):
        assert "realistic_ranks.md)" in (PAGES / page).read_text(encoding="utf-8"), page
