"""What a step of worlds has led to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats

__all__ = ["Result", "Step"]


@dataclass(frozen=True)
class Result:
    """What a step of n worlds with A learners each has led to.

    Attributes:
        reward: (n, A) sum of the terms; 0 for learners whose episode was over before.
        terminated: (n, A) whether the episode of a learner ended in this step: it arrived, or it collided.
        truncated: (n, A) whether it was cut off in this step without such an end: at the horizon, or because the world
            starts its next episode.
        active: (n, A) whether the episode of the learner was going on before the step.
        over: (n,) whether the world is over, so that it has to be reset.
        arrived, collided: (n, A) whether the learner arrived or began to collide in this step.
        terms: (T, n, A) terms of the reward times their weights, in the order of the task.
        contacts_between_steps: (n, A) number of contacts of the learner in its episode that began and ended within one
            step; with ``world.contacts: step_end`` they are no collisions.
    """

    reward: Floats
    terminated: NDArray[np.bool_]
    truncated: NDArray[np.bool_]
    active: NDArray[np.bool_]
    over: NDArray[np.bool_]
    arrived: NDArray[np.bool_]
    collided: NDArray[np.bool_]
    terms: Floats
    contacts_between_steps: NDArray[np.int32]


@dataclass(frozen=True)
class Step:
    """What :meth:`irsim.learning.Worlds.advance` returns.

    Attributes:
        result: What the step has led to.
        seen: (n * A, D) what the learners observe now: in worlds whose next episode has begun, of that one.
        last: (n * A, D) what learners observed last in episodes that ended in this step, in worlds whose next episode
            has begun; the other rows have no meaning.
    """

    result: Result
    seen: NDArray[np.float32]
    last: NDArray[np.float32]
