"""The kept trainings: their page follows from the outcomes, and outcomes from the weights."""

from __future__ import annotations

import pytest

from irsim.benchmarks.stored import measure_plan
from tests.benchmarks.trainings.train import RECIPES, SEEDS, weights_of
from tests.benchmarks.trainings.write import EPISODES, PAGE, Kept, kept_outcomes, lines_of, page, plan_of

KEPT = list(dict.fromkeys(one.policy for one in kept_outcomes()))


def test_the_page_follows_from_the_outcomes() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(kept_outcomes())


def test_each_training_has_its_weights_and_outcomes() -> None:
    assert [name for name in RECIPES if name in KEPT] == KEPT
    kept = {(one.policy, one.training) for one in kept_outcomes() if one.training != "shipped"}
    weights = {(name, str(seed)): weights_of(name, seed) for name in RECIPES for seed in SEEDS}
    assert kept == {key for key, file in weights.items() if file.is_file()}
    assert len({weights[key].read_bytes() for key in kept}) == len(kept)


def test_spreads_of_trainings_and_of_episodes_are_told_apart() -> None:
    half = "s" * 50 + "c" * 50
    same = [Kept("multi_robot", training, 5, half) for training in ("shipped", "0", "1", "2")]
    [row] = [line for line in page(same).splitlines() if line.startswith("| 5 |")]
    assert row == "| 5 | 50 | 50 | 50 | 50.0 | 0.0 | [40, 60] | 50.0 | 50 |"
    unlike = [Kept("multi_robot", str(seed), 5, "s" * 100 if seed < 2 else "t" * 100) for seed in range(3)]
    [row] = [line for line in page([same[0], *unlike]).splitlines() if line.startswith("| 5 |")]
    assert row == "| 5 | 100 | 100 | 0 | 66.7 | 57.7 [0, 100] | [57, 75] | 0.0 | 50 |"


@pytest.mark.slow(10)
@pytest.mark.parametrize("name", KEPT)
def test_episodes_end_as_they_are_kept(name: str) -> None:
    plan = plan_of(name, EPISODES[:2])
    wanted = {(one.training, one.robots): one.outcomes[:2] for one in kept_outcomes() if one.policy == name}
    made = {(one.training, one.robots): one.outcomes for one in lines_of(name, plan, measure_plan(plan).episodes)}
    assert made == wanted
