"""What a training reports after each round."""

from __future__ import annotations

from dataclasses import dataclass

from irsim.learning.training.success import Success

__all__ = ["Round"]


@dataclass(frozen=True)
class Round:
    """A finished round.

    Attributes:
        number: Its number, from 1.
        steps: Decisions of all learners so far, without those of learners that waited.
        seconds: Wall-clock time of all rounds so far [s].
        success: What the policy reaches on the validation seeds.
        best: Whether it is better than every earlier round: in success or, with equal success, in reward.
        rounds: Number of rounds of the whole training.
    """

    number: int
    steps: int
    seconds: float
    success: Success
    best: bool
    rounds: int
