"""Seeds that leave no room for an object: they are counted and named, and the next seed takes their place."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

from irsim.common.text import listed
from irsim.diagnostics.errors import PlacementError
from irsim.results.labels import CROWDED

__all__ = ["MAX_TRIES", "crowded_message", "first_with_room"]

T = TypeVar("T")
MAX_TRIES = 20
"""Number of seeds that are tried before a scenario counts as too crowded."""
_MAX_NAMED = 10
"""Number of seeds that a message names."""


def first_with_room(make: Callable[[int], T], seeds: Iterable[int]) -> tuple[T, list[int]]:
    """Make something with the first seed that leaves room for every object.

    Args:
        make: Function of a seed.
        seeds: Seeds to try, at least one.

    Returns:
        What was made, and the seeds before it that leave no room.

    Raises:
        PlacementError: None of the seeds leaves room; the error is that of the first one.
    """
    first: PlacementError | None = None
    crowded: list[int] = []
    for seed in seeds:
        try:
            return make(seed), crowded
        except PlacementError as error:
            first = first or error
            crowded.append(seed)
    assert first is not None
    raise first


def crowded_message(crowded: Sequence[int]) -> str | None:
    """Name the seeds that had no room; None if there are none."""
    if not crowded:
        return None
    many = len(crowded) > 1
    return f"seed{'s' * many} {listed([str(seed) for seed in crowded], _MAX_NAMED)} had no room ({CROWDED})"
