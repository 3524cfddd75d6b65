"""One step of all learners of all worlds: what reward terms see of it, and what it has led to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats

__all__ = ["Moment", "Result", "Step"]


@dataclass(frozen=True)
class Moment:
    """One step of n worlds with A learners each.

    Attributes:
        step_time: Period of the simulation [s].
        pose_before, pose: (n, A, 3) x, y [m], heading [rad] at the start and at the end of the step, world frame.
        goal: (n, A, 3) goal at the start of the step, in the same form; NaN without one.
        reached: (n, A) whether the learner reached a goal in this step: the last one, or one of several.
        arrived: (n, A) whether it arrived in this step: it reached its last goal, and had not before.
        collided: (n, A) whether it began to collide in this step.
        control: (n, A, 3) executed control, zero padded.
        control_before: (n, A, 3) control executed in the step before; zero at the start.
        low, high: (n, A, 3) limits of the controls, zero padded.
        velocity: (n, A, 2) true velocity [m/s], world frame.
        yaw_rate: (n, A) [rad/s].
        gaps: Function that measures, for each learner, the distance [m] between its footprint and the nearest one of
            the robots, the obstacles that move and the static objects, (n, A, 3). Larger ones than its argument [m] are
            infinite; negative ones are overlaps.
        commanded: (n, A, 2) velocity that the action asked for [m/s], world frame; 0 for actions that are controls.
        urgency: Function that returns (n, A) 1 / (t + 0.2 s), with the time t after which this velocity would have
            touched another one, as at the start of the step; 0 if it would not within 5 s.
    """

    step_time: float
    pose_before: Floats
    pose: Floats
    goal: Floats
    reached: NDArray[np.bool_]
    arrived: NDArray[np.bool_]
    collided: NDArray[np.bool_]
    control: Floats
    control_before: Floats
    low: Floats
    high: Floats
    velocity: Floats
    yaw_rate: Floats
    gaps: Callable[[float], Floats]
    commanded: Floats
    urgency: Callable[[], Floats]

    @cached_property
    def distance_before(self) -> Floats:
        """(n, A) distance to the goal at the start of the step [m]; NaN without a goal."""
        return _distance(self.pose_before, self.goal)

    @cached_property
    def distance(self) -> Floats:
        """(n, A) distance to the same goal at the end of the step [m]."""
        return _distance(self.pose, self.goal)

    @cached_property
    def direction_before(self) -> Floats:
        """(n, A, 2) unit vector to the goal at the start of the step, world frame; 0 without one, and at it."""
        distance = self.distance_before
        far = distance > 0  # not for NaN either
        length = np.where(far, distance, 1.0)
        direction = np.empty((*far.shape, 2))
        for k in range(2):
            direction[..., k] = np.where(far, (self.goal[..., k] - self.pose_before[..., k]) / length, 0.0)
        return direction


def _distance(pose: Floats, goal: Floats) -> Floats:
    x, y = goal[..., 0] - pose[..., 0], goal[..., 1] - pose[..., 1]  # arrays of one number each are faster than pairs
    result: Floats = np.sqrt(x * x + y * y)
    return result


@dataclass(frozen=True)
class Result:
    """Result of a step of n worlds with A learners each.

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
            step; with ``world.contacts: step_end`` they do not count as collisions.
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
    """Return value of :meth:`irsim.learning.Worlds.advance`.

    Attributes:
        result: The result of the step.
        seen: (n * A, D) what the learners observe now: in worlds whose next episode has begun, of that one.
        last: (n * A, D) what learners observed last in episodes that ended in this step, in worlds whose next episode
            has begun; the other rows have no meaning.
    """

    result: Result
    seen: NDArray[np.float32]
    last: NDArray[np.float32]
