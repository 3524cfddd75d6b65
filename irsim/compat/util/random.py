"""Random numbers of scripts: the generator of the environment used last (see :attr:`irsim.env.Env.rng`)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.simulation.active_env import current_rng, set_current_rng

__all__ = ["random_uniform", "rng", "set_seed"]

_ATTEMPTS = 100


class _Follower:
    """A NumPy generator that is always that of the environment used last; one of its own before there is any."""

    def __getattr__(self, name: str) -> Any:
        return getattr(current_rng(), name)


rng: Any = _Follower()
"""Has every method of :class:`numpy.random.Generator`."""


def set_seed(seed: int | None = None) -> None:
    """Begin ``rng`` anew; the environment itself keeps its draws (``env.set_random_seed`` is for those).

    Args:
        seed: Any seed of NumPy; None takes fresh entropy.
    """
    set_current_rng(np.random.default_rng(seed))


def random_uniform(
    low: Any = None, high: Any = None, size: tuple[int, int] = (3, 1), min_distance: float = 1.0
) -> NDArray[np.float64]:
    """Points drawn evenly from a box, kept apart as far as that works.

    Args:
        low: Lower bounds, one per row; default [0, 0, -pi].
        high: Upper bounds; default [10, 10, pi].
        size: Rows and number of points.
        min_distance: Between the first two coordinates of any two points [m]; given up after 100 draws per point.

    Returns:
        (rows, points).
    """
    rows, number = size
    lower = np.array([0.0, 0.0, -np.pi][:rows] if low is None else low, dtype=np.float64).reshape(-1)
    upper = np.array([10.0, 10.0, np.pi][:rows] if high is None else high, dtype=np.float64).reshape(-1)
    points: list[NDArray[np.float64]] = []
    for _ in range(number):
        for _ in range(_ATTEMPTS):
            point = rng.uniform(lower, upper)
            if all(np.hypot(*(point[:2] - other[:2])) >= min_distance for other in points):
                break
        points.append(point)
    return np.array(points).T.reshape(rows, number)
