"""The seeds of a benchmark, given as their number or one by one."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from irsim.common.arguments import as_given, is_whole_number
from irsim.diagnostics.errors import InputError

__all__ = ["seeds_from", "seeds_text"]

_MAX_SEEDS = 1_000_000
"""Greatest number of seeds."""
_FIX = "give the number of seeds, such as 20, or the seeds, such as [1, 4, 7], '5-9' or '1,4,7'"
"""Fix of every message about invalid seeds."""


def seeds_from(given: Any) -> list[int]:
    """The seeds, each once.

    Args:
        given: The number of seeds (0, 1, 2, …), an iterable of seeds, or either as text: ``20``, ``5-9``, ``5..9``,
            ``1,4,7``.

    Raises:
        InputError: ``given`` is neither, or there are no seeds or too many.
    """
    values: Iterable[Any]
    if isinstance(given, str):
        values = _read(given.replace(" ", ""))
    elif is_whole_number(given):
        values = range(_checked_number(int(given)))
    elif isinstance(given, Iterable) and not isinstance(given, (Mapping, bytes, bytearray)):
        values = list(given)
    else:
        raise _wrong(given)
    for seed in values:
        if not is_whole_number(seed):
            raise _wrong(seed)
    seeds = list(dict.fromkeys(int(seed) for seed in values))
    if not seeds:
        raise InputError("there must be at least one seed, got none", "give at least one seed", "seeds")
    if min(seeds) < 0 or max(seeds) >= 2**64:
        raise InputError("a seed must be from 0 to 2^64 - 1", "give seeds from 0", "seeds")
    return seeds


def _read(text: str) -> Iterable[int]:
    """The seeds of a text, as the command line has them."""
    if text.isdecimal() and len(text) < 20:
        return range(_checked_number(int(text)))
    seeds: list[int] = []
    for part in text.strip(",").split(","):
        ends = re.fullmatch(r"(\d{1,20})(?:(?:-|\.\.)(\d{1,20}))?", part)
        low, high = (0, -1) if ends is None else (int(ends[1]), int(ends[2] or ends[1]))
        if ends is None or not 0 <= high - low < _MAX_SEEDS:
            raise _wrong(text)
        seeds += range(low, high + 1)
    return seeds


def _checked_number(number: int) -> int:
    """The number of seeds, unless it is too large."""
    if number > _MAX_SEEDS:
        raise InputError(f"{number:,} seeds are too many", f"give at most {_MAX_SEEDS:,}", "seeds")
    return number


def _wrong(given: Any) -> InputError:
    return InputError(f"{as_given(given)} is not a valid seed or list of seeds", _FIX, "seeds")


def seeds_text(seeds: list[int]) -> str:
    """The seeds as the command line takes them."""
    if len(seeds) > 1 and seeds == list(range(seeds[0], seeds[0] + len(seeds))):
        return str(len(seeds)) if seeds[0] == 0 else f"{seeds[0]}-{seeds[-1]}"
    return ",".join(map(str, seeds)) if seeds != [0] else "1"
