"""Random numbers for scripts, from the generator of the environment used last (see :attr:`irsim.env.Env.rng`)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.simulation.active_env import current_rng, last_used, seed_next, set_current_rng
from irsim.simulation.random_streams import check_seed

__all__ = ["random_uniform", "rng", "set_seed"]

_BEFORE_FIRST = 2**32 - 1
"""Number of an episode of noise after which the next reset starts with number 0."""
MAX_ATTEMPTS = 1000
"""Number of draws per point after which the distance to other points is ignored."""


class _Follower:
    """Forwards to the generator of the environment used last, or to a separate one before the first environment."""

    def __getattr__(self, name: str) -> Any:
        return getattr(current_rng(), name)


rng: Any = _Follower()
"""The present generator, with all methods of :class:`numpy.random.Generator`."""


def set_seed(seed: int | None = None) -> None:
    """Restart ``rng`` with a seed, which from now on also determines noise and scenes.

    This concerns the environment used last: its noise from the next step on, and its next ``reset(random=True)``,
    which starts the first scene of this seed. Its present scene stays until then; ``env.set_random_seed`` replaces
    it at any next reset. Without an environment, or if the one used last was made without a seed, the seeds of the next
    environments that are made without one follow from this seed, too; the first has this seed itself.

    Args:
        seed: A seed for NumPy; None takes fresh entropy.
    """
    env, number = last_used(), _seed_of(seed)
    if env is None or (env._wanted_seed is None and env.scenario.world.seed is None):
        seed_next(number)
    if env is not None:
        env._next_seed = number
        state = env.simulation.state
        state.seed[0], state.scene[0], state.noise[0] = number, 0, _BEFORE_FIRST
    set_current_rng(np.random.default_rng(seed))


def _seed_of(seed: Any) -> int:
    """Return the seed of an environment for a seed of NumPy: the same number if that is possible."""
    try:
        return check_seed(seed)
    except (TypeError, ValueError):
        return int(np.random.default_rng(seed).integers(2**32))


def random_uniform(
    low: Any = None, high: Any = None, size: tuple[int, int] = (3, 1), min_distance: float = 1.0
) -> NDArray[np.float64]:
    """Draw points uniformly from a box, if possible with a minimum distance.

    Args:
        low: Lower bounds, one per row; default [0.5, 0.5, 0].
        high: Upper bounds; default [9.5, 9.5, 6.28].
        size: Number of rows that are drawn, 2 or 3, and number of points.
        min_distance: Smallest distance of two points in their first two coordinates [m]. After 1000 draws for a point,
            the last one is taken whatever its distance.

    Returns:
        (3, points) array; rows that are not drawn are 0.
    """
    rows, number = size
    lower = np.array([0.5, 0.5, 0.0] if low is None else low, dtype=np.float64).reshape(-1)[:rows]
    upper = np.array([9.5, 9.5, 6.28] if high is None else high, dtype=np.float64).reshape(-1)[:rows]
    points: NDArray[np.float64] = np.zeros((3, number))
    for index in range(number):
        for _ in range(MAX_ATTEMPTS):
            point = rng.uniform(lower, upper)
            if (np.hypot(*(points[:2, :index] - point[:2, None])) >= min_distance).all():
                break
        points[:rows, index] = point
    return points
