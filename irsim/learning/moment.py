"""What reward terms see: one step of all learners of all worlds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats

__all__ = ["Moment"]


@dataclass(frozen=True)
class Moment:
    """One step of n worlds with A learners each.

    Attributes:
        step_time: Period of the simulation [s].
        distance_before: (n, A) distance to the goal at the start of the step [m]; NaN without a goal.
        distance: (n, A) distance to the same goal at the end of the step [m].
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
        direction_before: (n, A, 2) unit vector to the goal at the start of the step, world frame; 0 without one.
        commanded: (n, A, 2) velocity that the action asked for [m/s], world frame; 0 for actions that are controls.
        urgency: Function that returns (n, A) 1 / (t + 0.2 s), with the time t after which this velocity would have
            touched another one, as at the start of the step; 0 if it would not within 5 s.
    """

    step_time: float
    distance_before: Floats
    distance: Floats
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
    direction_before: Floats
    commanded: Floats
    urgency: Callable[[], Floats]
