"""Estimators of published methods, for tests and for the plots of the documentation site."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

__all__ = ["allan", "umbmark"]


def allan(values: np.ndarray, dt: float, groups: Sequence[int]) -> np.ndarray:
    """Overlapping Allan deviation at some cluster sizes.

    Args:
        values: (K,) or (K, n) readings; of n series the variances are averaged.
        dt: Time between readings [s].
        groups: (G,) numbers of readings in a cluster.

    Returns:
        (G,) deviations, in the unit of the readings.
    """
    angle = np.concatenate([np.zeros_like(values[:1]), np.cumsum(values, axis=0) * dt])
    out = []
    for m in groups:
        second = angle[2 * m :] - 2 * angle[m:-m] + angle[: -2 * m]
        out.append(math.sqrt(float(np.mean(second**2)) / (2 * (m * dt) ** 2)))
    return np.array(out)


def umbmark(clockwise: float, counter: float, length: float, track: float) -> tuple[float, float]:
    """Systematic errors of odometry from two squares (Borenstein and Feng 1996, equations 3.9 to 3.21).

    Args:
        clockwise, counter: True minus believed x at the end of a square to the right and to the left, as believed [m].
        length: Side of the squares [m].
        track: Distance of the wheels [m].

    Returns:
        True diameter of the right wheel over the left one, and true track over the believed one.
    """
    alpha, beta = (clockwise + counter) / (-4 * length), (clockwise - counter) / (-4 * length)
    radius = length / 2 / math.sin(beta / 2)
    return (radius + track / 2) / (radius - track / 2), (math.pi / 2) / (math.pi / 2 - alpha)
