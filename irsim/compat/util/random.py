"""Random numbers for scripts, from the generator of the environment used last (see :attr:`irsim.env.Env.rng`)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.simulation.active_env import current_rng, set_current_rng

__all__ = ["random_uniform", "rng", "set_seed"]

MAX_ATTEMPTS = 100
"""Number of draws per point after which the distance to other points is ignored."""


class _Follower:
    """Forwards to the generator of the environment used last, or to a separate one before the first environment."""

    def __getattr__(self, name: str) -> Any:
        return getattr(current_rng(), name)


rng: Any = _Follower()
"""The present generator, with all methods of :class:`numpy.random.Generator`."""


def set_seed(seed: int | None = None) -> None:
    """Restart ``rng`` with a seed; the draws of the environment itself do not change (see ``env.set_random_seed``).

    Args:
        seed: A seed for NumPy; None takes fresh entropy.
    """
    set_current_rng(np.random.default_rng(seed))


def random_uniform(
    low: Any = None, high: Any = None, size: tuple[int, int] = (3, 1), min_distance: float = 1.0
) -> NDArray[np.float64]:
    """Draw points uniformly from a box, if possible with a minimum distance.

    Args:
        low: Lower bounds, one per row; default [0, 0, -pi].
        high: Upper bounds; default [10, 10, pi].
        size: Number of rows and of points.
        min_distance: Smallest distance of two points in their first two coordinates [m]. After 100 draws for a point,
            the last one is taken whatever its distance.

    Returns:
        (rows, points) array.
    """
    rows, number = size
    lower = np.array([0.0, 0.0, -np.pi][:rows] if low is None else low, dtype=np.float64).reshape(-1)
    upper = np.array([10.0, 10.0, np.pi][:rows] if high is None else high, dtype=np.float64).reshape(-1)
    points: list[NDArray[np.float64]] = []
    for _ in range(number):
        for _ in range(MAX_ATTEMPTS):
            point = rng.uniform(lower, upper)
            if all(np.hypot(*(point[:2] - other[:2])) >= min_distance for other in points):
                break
        points.append(point)
    return np.array(points).T.reshape(rows, number)
