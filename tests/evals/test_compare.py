"""``irsim-evals compare`` and its statistics: what changed, and whether it means anything."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

import irsim.metrics
from irsim_evals.grader.outcome import Cost
from irsim_evals.report.comparison import compare, smallest_difference
from irsim_evals.results import Trial
from irsim_evals.statistics import mcnemar, mean_pass_hat_k, paired_bootstrap, pass_hat_k, sign_flip, wilson
from tests.evals.conftest import file_of, irsim_evals, refusal, trial


@pytest.mark.parametrize(
    ("before", "after", "code", "said"),
    [
        ([trial("one", True), trial("two", False)], [trial("one", True), trial("two", True)], 0,
         ["FIXED  two: Title of two"]),
        ([trial("one", True), trial("two", False)], [trial("one", False), trial("two", True)], 1,
         ["BROKEN one: Title of one", "size: expected radius 0.2; observed radius 0.3"]),
        ([trial("one", k < 3, number=k) for k in range(5)], [trial("one", k < 2, number=k) for k in range(5)], 1,
         ["BROKEN one: Title of one (60% → 40% of the attempts)"]),
    ],
    ids=["fixed", "broken", "most attempts"],
)  # fmt: skip
def test_a_case_that_changes_is_named_with_its_reason(
    before: list[Trial], after: list[Trial], code: int, said: list[str], tmp_path: Path
) -> None:
    done = irsim_evals("compare", file_of(tmp_path / "a.json", *before), file_of(tmp_path / "b.json", *after))
    assert done.exit_code == code, done.output
    assert [text for text in said if text not in done.output] == []
    assert ("BROKEN" in done.output) == bool(code)


def test_json_says_the_same(tmp_path: Path) -> None:
    a = file_of(tmp_path / "a.json", *(trial(f"case-{k}", k < 8) for k in range(20)))
    b = file_of(tmp_path / "b.json", *(trial(f"case-{k}", k >= 1) for k in range(20)))
    done = irsim_evals("compare", a, b, "--json")
    assert done.exit_code == 1
    (data,) = json.loads(done.stdout)
    assert (data["pairs"], data["passed"]) == (20, [8, 19])
    assert [one["case"] for one in data["broken"]] == ["case-0"]
    assert len(data["fixed"]) == 12
    assert data["p"] == pytest.approx(2 * (1 + 13) / 2**13)
    assert data["difference"]["estimate"] == pytest.approx(11 / 20)
    assert data["difference"]["low"] < 11 / 20 < data["difference"]["high"]
    assert data["means_something"] is True
    assert data["sentence"].endswith("20 cases would show a difference of 48 points.")
    assert data["sentences"] == [data["sentence"]]


def test_folders_of_reports_can_be_compared(tmp_path: Path) -> None:
    file_of(tmp_path / "a" / "results.json", trial("one", True))
    file_of(tmp_path / "b" / "results.json", trial("one", False))
    assert irsim_evals("compare", tmp_path / "a", tmp_path / "b").exit_code == 1


def test_two_arms_of_one_file(tmp_path: Path) -> None:
    both = file_of(
        tmp_path / "a.json", trial("one", False, "rules"), trial("one", True, "skill"), trial("x", True, "mcp")
    )
    done = irsim_evals("compare", both, "--arm", "rules", "--arm", "skill")
    assert done.exit_code == 0
    assert "skill passes 1 of 1 cases and rules 0" in done.output
    assert irsim_evals("compare", both, "--arm", "skill", "--arm", "rules").exit_code == 1
    assert irsim_evals("compare", both).exit_code == 2


def test_files_with_several_arms_are_compared_arm_by_arm(tmp_path: Path) -> None:
    a = file_of(tmp_path / "a.json", trial("one", True, "rules"), trial("one", True, "skill"))
    b = file_of(tmp_path / "b.json", trial("one", True, "rules"), trial("one", False, "skill"))
    done = irsim_evals("compare", a, b, "--json")
    assert done.exit_code == 1
    assert [len(one["broken"]) for one in json.loads(done.stdout)] == [0, 1]
    assert irsim_evals("compare", a, b, "--arm", "rules").exit_code == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["a.json", "missing.json"], "no file of results"),
        (["a.json", "text.json"], "not a file of results"),
        (["a.json", "other.json"], "different cases"),
        (["a.json", "empty.json"], "no trials"),
        (["a.json", "elsewhere.json"], "no case in common"),
        (["a.json", "b.json", "--arm", "unknown"], "no arm called 'unknown'"),
        (["a.json", "b.json", "a.json"], "two sides"),
        (["a.json", "a.json"], "given twice"),
        (["a.json", "mcp.json", "--json"], "--arm"),
    ],
)
def test_bad_input(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], message: str) -> None:
    monkeypatch.chdir(tmp_path)
    file_of(Path("a.json"), trial("one", True), trial("one", True, "rules"))
    file_of(Path("b.json"), trial("one", True))
    file_of(Path("mcp.json"), trial("one", True, "mcp"), trial("one", True, "none"))
    file_of(Path("other.json"), trial("one", True), cases="def")
    file_of(Path("elsewhere.json"), trial("two", True), trial("two", True, "rules"))
    file_of(Path("empty.json"))
    Path("text.json").write_text("[1, 2")
    assert message in refusal("compare", *words)


def test_no_change_says_so() -> None:
    trials = [trial(f"case-{k}", True) for k in range(10)]
    comparison = compare(trials, trials, "before", "after")
    assert (comparison.p, comparison.fixed, comparison.broken) == (1.0, [], [])
    assert "no case changed" in comparison.sentence


def test_one_case_more_may_be_chance_and_ten_more_are_not() -> None:
    before = [trial(f"case-{k}", k < 10) for k in range(30)]
    one_more, ten_more = ([trial(f"case-{k}", k < n) for k in range(30)] for n in (11, 20))
    assert "no difference that chance would not explain. 30 cases" in compare(before, one_more, "a", "b").sentence
    assert "hardly chance" in compare(before, ten_more, "a", "b").sentence


def test_cases_of_one_family_say_less_than_independent_ones() -> None:
    def width(family: Any) -> float:
        before = [trial(f"case-{k}", False, family=family(k)) for k in range(20)]
        after = [trial(f"case-{k}", k % 4 == 0, family=family(k)) for k in range(20)]
        interval = compare(before, after, "a", "b").difference
        return interval.high - interval.low

    assert width(lambda k: f"family-{k % 4}") > 1.5 * width(lambda k: f"family-{k}")


def with_costs(calls: Any, family: Any = str, count: int = 24) -> list[Trial]:
    return [
        trial(f"case-{k}", True, family=family(k), cost=Cost(calls=calls(k), tokens=100 * calls(k)))
        for k in range(count)
    ]


def test_fewer_calls_are_told_from_chance() -> None:
    before, fewer = with_costs(lambda k: 5 + k % 3), with_costs(lambda k: 4 + k % 2)
    calls, tokens = compare(before, fewer, "A", "B").sentences[1:]
    assert calls == "B needs 1.5 calls fewer a case (95 %: 1.1 to 1.9; 6.0 before, 4.5 now, 24 cases)."
    assert tokens.startswith("B needs 150 tokens fewer a case (95 %: ")
    assert "A needs 1.5 calls more a case" in compare(fewer, before, "B", "A").sentences[1]
    other = with_costs(lambda k: 5 + (k + 1) % 3)
    assert (
        compare(before, other, "A", "B")
        .sentences[1]
        .startswith("No difference in calls that chance would not explain (95 %: -0.")
    )


def test_calls_of_one_family_or_of_few_cases_may_be_chance() -> None:
    sides = [with_costs(calls, lambda k: f"family-{k % 3}") for calls in (lambda k: 6, lambda k: 5)]
    assert "chance would not explain" in compare(*sides, "A", "B").sentences[1]
    sides = [with_costs(calls, count=5) for calls in (lambda k: 6, lambda k: 5)]
    assert "chance would not explain" in compare(*sides, "A", "B").sentences[1]


def test_attempts_without_a_cost_are_left_out() -> None:
    before = [*with_costs(lambda k: 3, count=8), trial("case-8", True)]
    (calls, _) = compare(before, with_costs(lambda k: 2, count=9), "A", "B").costs
    assert (calls.pairs, calls.before, calls.after) == (8, 3, 2)
    assert compare([trial("one", True)], [trial("one", True)], "A", "B").costs == []


def test_a_permutation_test_counts_the_signs():
    assert sign_flip({str(k): [1.0] for k in range(6)}) == 2 / 64
    assert sign_flip({"a": [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]}) == 1
    assert sign_flip({}) == 1
    assert sign_flip({str(k): [1.0] for k in range(40)}) <= 2 / 10_000
    assert sign_flip({str(k): [(-1.0) ** k] for k in range(40)}) == 1


@pytest.mark.parametrize(
    ("pairs", "changing", "points"), [(60, 0.1, 12.6), (60, 0.2, 16), (60, 0.3, 20), (120, 0.1, 8), (120, 0.3, 14)]
)
def test_smallest_difference_agrees_with_tables(pairs: int, changing: float, points: float) -> None:
    difference = smallest_difference(pairs, changing)
    assert difference is not None
    assert 100 * difference == pytest.approx(points, abs=1)


def test_five_cases_show_no_difference() -> None:
    assert smallest_difference(5, 0.2) is None
    five = [trial(f"case-{k}", k > 5) for k in range(5)], [trial(f"case-{k}", True) for k in range(5)]
    assert "5 cases are too few to show any difference" in compare(*five, "a", "b").sentence


def test_wilson_without_trials_says_that_nothing_is_known():
    assert wilson(7, 10) == (0.7, *irsim.metrics.wilson(7, 10))
    interval = wilson(0, 0)
    assert math.isnan(interval.estimate)
    assert interval[1:] == (0.0, 1.0)


@pytest.mark.parametrize(("passed", "total"), [(3, 2), (-1, 2)])
def test_impossible_counts_are_an_error(passed, total):
    with pytest.raises(ValueError, match="not possible"):
        wilson(passed, total)
    with pytest.raises(ValueError, match="not possible"):
        pass_hat_k(passed, total, 1)


@pytest.mark.parametrize(
    ("passed", "total", "k", "chance"),
    [(3, 4, 1, 3 / 4), (3, 4, 2, 3 / 6), (3, 4, 3, 1 / 4), (3, 4, 4, 0), (5, 5, 5, 1)],
)
def test_pass_hat_k_counts_the_draws_that_all_pass(passed, total, k, chance):
    assert pass_hat_k(passed, total, k) == chance


@pytest.mark.parametrize(("k", "message"), [(3, "there are 2"), (0, "at least 1")])
def test_pass_hat_k_needs_k_attempts(k, message):
    with pytest.raises(ValueError, match=message):
        pass_hat_k(2, 2, k)


def test_mean_pass_hat_k_leaves_out_cases_with_few_attempts():
    assert mean_pass_hat_k([(3, 4), (4, 4), (1, 1)], 2) == pytest.approx((0.5 + 1) / 2)
    assert math.isnan(mean_pass_hat_k([(1, 1)], 2))


def test_mcnemar_is_the_binomial_tail():
    assert mcnemar(0, 0) == 1
    assert mcnemar(5, 5) == 1
    assert mcnemar(0, 6) == 2 / 64
    assert mcnemar(6, 0) == 2 / 64
    assert mcnemar(1, 7) == 2 * (1 + 8) / 256
    with pytest.raises(ValueError, match="not negative"):
        mcnemar(-1, 2)


@pytest.mark.parametrize(
    ("differences", "mean"), [({"a": [1, 1], "b": [1], "c": [1, 1, 1]}, 1), ({"a": [0, 1, 1, 0]}, 0.5)]
)
def test_paired_bootstrap_of_equal_differences_or_of_one_family_has_no_width(differences, mean):
    assert paired_bootstrap(differences) == (mean, mean, mean)


def test_paired_bootstrap_agrees_with_the_normal_approximation():
    count, share = 400, 0.25
    differences = {str(i): [1.0 if i < share * count else 0.0] for i in range(count)}
    interval = paired_bootstrap(differences)
    half = 1.96 * math.sqrt(share * (1 - share) / count)
    assert interval.estimate == share
    assert interval.low == pytest.approx(share - half, abs=0.005)
    assert interval.high == pytest.approx(share + half, abs=0.005)


def test_paired_bootstrap_draws_whole_families_and_the_same_ones_each_time():
    together = {"a": [1.0] * 10, "b": [0.0] * 10}
    alone = {f"a{i}": [1.0] for i in range(10)} | {f"b{i}": [0.0] for i in range(10)}
    wide, narrow = paired_bootstrap(together), paired_bootstrap(alone)
    assert wide.high - wide.low > narrow.high - narrow.low
    assert paired_bootstrap(together, seed=3) == paired_bootstrap(together, seed=3)
    assert math.isnan(paired_bootstrap({}).estimate)
