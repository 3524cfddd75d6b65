"""Which round of a training is the best."""

from __future__ import annotations

from irsim.learning.training.run_folder import merit


def test_more_success_is_better_and_with_equal_success_more_reward() -> None:
    rounds = [{"learners": 0.9, "reward": 5.0}, {"learners": 1.0, "reward": 2.0}, {"learners": 1.0, "reward": 3.0}]
    assert max(rounds, key=merit) is rounds[2]
    assert max(rounds[:2], key=merit) is rounds[1]
