"""Seeds of a benchmark: how many, or which."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from irsim.common.arguments import as_given, is_whole_number
from irsim.scenario.behavior_override import BenchmarkError

__all__ = ["seeds_from"]

_MOST = 1_000_000
_TELL = "give how many, such as 20, or which, such as [1, 4, 7], '5-9' or '1,4,7'"


def seeds_from(given: Any) -> list[int]:
    """The seeds that are meant, each once.

    Args:
        given: How many (0, 1, 2, …); an iterable of those; or either as text of a command line: ``20``, ``5-9``,
            ``1,4,7``.

    Raises:
        BenchmarkError: It is none of that.
    """
    found: Iterable[Any]
    if isinstance(given, str):
        found = _read(given.replace(" ", ""))
    elif is_whole_number(given):
        found = range(_counted(int(given)))
    elif isinstance(given, Iterable) and not isinstance(given, (Mapping, bytes, bytearray)):
        found = list(given)
    else:
        raise _wrong(given)
    for seed in found:
        if not is_whole_number(seed):
            raise _wrong(seed)
    seeds = list(dict.fromkeys(int(seed) for seed in found))
    if not seeds:
        raise BenchmarkError("there are no seeds", "give at least one of the seeds", "seeds")
    if min(seeds) < 0 or max(seeds) >= 2**64:
        raise BenchmarkError("a seed is outside 0 to 2^64 - 1", "give seeds from 0", "seeds")
    return seeds


def _read(text: str) -> Iterable[int]:
    """Seeds as the command line has them."""
    if text.isdecimal() and len(text) < 20:
        return range(_counted(int(text)))
    found: list[int] = []
    for part in text.strip(",").split(","):
        ends = re.fullmatch(r"(\d{1,20})(?:-(\d{1,20}))?", part)
        low, high = (0, -1) if ends is None else (int(ends[1]), int(ends[2] or ends[1]))
        if ends is None or not 0 <= high - low < _MOST:
            raise _wrong(text)
        found += range(low, high + 1)
    return found


def _counted(number: int) -> int:
    if number > _MOST:
        raise BenchmarkError(f"{number:,} seeds are too many", f"give at most {_MOST:,}", "seeds")
    return number


def _wrong(given: Any) -> BenchmarkError:
    return BenchmarkError(f"{as_given(given)} is no seed, nor several", _TELL, "seeds")
