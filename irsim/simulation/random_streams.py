"""Named random streams: each drawn number depends only on (seed, scene, noise episode, stream, object, draw)."""

from __future__ import annotations

import secrets
from typing import TYPE_CHECKING

import irsim._core as core
from irsim.diagnostics.errors import InputError, InputTypeError

if TYPE_CHECKING:
    import numpy as np

__all__ = ["MAX_SEED", "check_seed", "fresh_seed", "generator"]

MAX_SEED = 2**64 - 1
"""Largest seed: 64 bits."""


def fresh_seed() -> int:
    """Return a seed from the entropy of the operating system, of only 32 bits so that it is easy to retype."""
    return secrets.randbits(32)


def check_seed(seed: object) -> int:
    """Return ``seed`` as an integer, after checking that it fits 64 bits.

    Raises:
        TypeError: The seed is not an integer.
        ValueError: The seed is negative or exceeds 64 bits.
    """
    if isinstance(seed, bool) or not hasattr(seed, "__index__"):
        raise InputTypeError(f"seed must be a whole number from 0 to 2**64 - 1, got {seed!r}")
    value = int(seed.__index__())
    if not 0 <= value <= MAX_SEED:
        raise InputError(f"seed must be a whole number from 0 to 2**64 - 1, got {value}")
    return value


def generator(
    seed: int, scene: int, noise: int, stream: str, object_id: int = 0, *, index: int = 0, first: int = 0
) -> np.random.Generator:
    """Return a NumPy generator for one stream, for code outside the core.

    Args:
        seed: Seed of the world, 64 bits.
        scene: Number of calls of ``reset(random=True)``.
        noise: Number of calls of ``reset()`` in this scene.
        stream: Name of the stream in ``irsim._core.STREAMS``.
        object_id: Id of the object that draws.
        index: Index among several streams of that name, such as the index of a sensor among the sensors of its object.
        first: Number of the first block of draws.
    """
    import numpy as np

    key = [seed, scene << 32 | noise]
    counter = [first, object_id, core.STREAMS[stream] + 16 * index, 0]
    return np.random.Generator(
        np.random.Philox(key=np.array(key, dtype=np.uint64), counter=np.array(counter, dtype=np.uint64))
    )
