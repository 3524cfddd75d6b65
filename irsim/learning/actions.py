"""Reads the actions that an environment receives, and delays them where learners have a latency."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arguments import as_given
from irsim.common.arrays import Floats
from irsim.diagnostics.errors import ArgumentError

__all__ = ["Latency", "read_actions"]


def read_actions(actions: Any, choices: Sequence[Any] | None, slots: int, width: int) -> Floats:
    """(slots, F) numbers that :func:`irsim.policies.networks.output.decide` reads.

    Args:
        actions: (slots, width) numbers from -1 to 1, or (slots,) numbers of choices.
        choices: The actions to choose from; None: actions are numbers.
        slots: Number of learners.
        width: Number of numbers of an action.

    Raises:
        ArgumentError: The actions have another shape, or are not finite.
    """
    given = as_array(actions)
    if choices is None:
        numbers = given.astype(np.float64, copy=False)
        if numbers.shape != (slots, width):
            what = f"actions have the shape {numbers.shape}, not {(slots, width)}"
            raise ArgumentError(what, "give one row of numbers for each learner of each world")
        if not np.isfinite(numbers).all():
            raise ArgumentError("an action is not finite", "give numbers from -1 to 1")
        return numbers
    number = given
    if number.shape != (slots,) or number.dtype.kind not in "iu":
        raise ArgumentError("actions are numbers of choices, one whole number for each learner", "give integers")
    if ((number < 0) | (number >= len(choices))).any():
        raise ArgumentError(f"an action is not the number of a choice, 0 to {len(choices) - 1}", "give one of them")
    numbers = np.zeros((slots, len(choices)))
    numbers[np.arange(slots), number] = 1.0
    return numbers


def as_array(actions: Any) -> NDArray[Any]:
    """Actions as an array of numbers.

    Raises:
        ArgumentError: They are something else.
    """
    try:
        given = np.asarray(actions)
    except ValueError:  # rows of different lengths
        given = np.asarray(None)
    if given.dtype.kind not in "fiub":
        raise ArgumentError(f"the action is {as_given(actions)}", "give an array of numbers")
    return given


class Latency:
    """Keeps the last actions of all learners.

    Args:
        most: Largest latency [steps].
        worlds: Number of worlds.
        learners: Number of learners in each.

    Attributes:
        steps: (n * A,) latency of each learner.
    """

    def __init__(self, most: int, worlds: int, learners: int) -> None:
        self._most, self._learners = most, learners
        self._slots = np.arange(worlds * learners)
        self._sent: Floats | None = None
        self._now = 0
        self.steps: NDArray[np.int64] = np.zeros(worlds * learners, dtype=np.int64)

    def pass_on(self, numbers: Floats, count: NDArray[np.int64]) -> tuple[Floats, NDArray[np.bool_]]:
        """The actions that are executed now.

        Args:
            numbers: (n * A, F) actions that were decided now.
            count: (n,) steps of the present episodes.

        Returns:
            (n * A, F) actions, and (n * A,) whether a learner still waits for its first one.
        """
        if self._sent is None:
            self._sent = np.zeros((self._most + 1, *numbers.shape))
        self._now = (self._now + 1) % len(self._sent)
        self._sent[self._now] = numbers
        delayed = self._sent[(self._now - self.steps) % len(self._sent), self._slots]
        return delayed, np.repeat(count, self._learners) < self.steps
