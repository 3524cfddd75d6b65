"""Named random streams: what is drawn, for whom, depends only on (seed, scene, noise episode, stream, object, draw)."""

from __future__ import annotations

import secrets
from typing import TYPE_CHECKING

import irsim._core as core

if TYPE_CHECKING:
    import numpy as np

__all__ = ["MAX_SEED", "check_seed", "fresh_seed", "generator"]

MAX_SEED = 2**64 - 1


def fresh_seed() -> int:
    """A seed from the operating system's entropy, short enough to type again."""
    return secrets.randbits(32)


def check_seed(seed: object) -> int:
    """``seed`` as an integer of 64 bits.

    Raises:
        TypeError: Not an integer.
        ValueError: Negative or wider than 64 bits.
    """
    if isinstance(seed, bool) or not hasattr(seed, "__index__"):
        raise TypeError(f"a seed is a whole number from 0 to 2**64 - 1, not {seed!r}")
    value = int(seed.__index__())
    if not 0 <= value <= MAX_SEED:
        raise ValueError(f"a seed is a whole number from 0 to 2**64 - 1, not {value}")
    return value


def generator(
    seed: int, scene: int, noise: int, stream: str, object_id: int = 0, *, index: int = 0, first: int = 0
) -> np.random.Generator:
    """A NumPy generator on one stream, for code that lives outside the core.

    Args:
        seed: Seed of the world, 64 bits.
        scene: Counter of ``reset(random=True)``.
        noise: Counter of ``reset()`` since then.
        stream: Name in ``irsim._core.STREAMS``.
        object_id: Whose draws.
        index: Which of several streams of that name: the place of a sensor among those of its object.
        first: Number of the first block of draws.
    """
    import numpy as np

    key = [seed, scene << 32 | noise]
    counter = [first, object_id, core.STREAMS[stream] + 16 * index, 0]
    return np.random.Generator(
        np.random.Philox(key=np.array(key, dtype=np.uint64), counter=np.array(counter, dtype=np.uint64))
    )
