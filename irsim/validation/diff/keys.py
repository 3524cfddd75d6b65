"""Differences between the data of two scenario files, by key."""

from __future__ import annotations

import bisect
import difflib
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from irsim.diagnostics.diagnostic import Path, format_path
from irsim.results.validation import KeyChange

if TYPE_CHECKING:
    from irsim.scenario.yaml.document import Document

__all__ = ["Pairs", "changed_keys", "data_of", "entry_pairs", "moved", "place", "same"]

_LISTS = ("robot", "obstacle", "sensors", "sensor", "parts", "zones")
"""Keys whose list items are matched by content, so that an inserted item does not change all after it."""
_MIN_LIKENESS = 0.34
"""Least share of common leaves of two items that match."""
_MAX_CANDIDATES = 10_000
"""Number of pairs up to which every item is compared with every other; beyond it, only items in equal places."""

Pairs = list[tuple[int | None, int | None]]
"""Indices of matching items of two lists; None where an item has no match."""


def data_of(document: Document) -> Any:
    """The data of a document, in which a single robot or obstacle is a list of one item."""
    data = document.data
    if not isinstance(data, Mapping):
        return data
    return {
        key: [value] if key in ("robot", "obstacle") and isinstance(value, Mapping) else value
        for key, value in data.items()
    }


def changed_keys(a: Any, b: Any, path: Path) -> Iterator[KeyChange]:
    """Changes from ``a`` to ``b``; the path of a removed item is that in ``a``, all other paths are those in ``b``."""
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        for key in dict.fromkeys([*a, *b]):
            if key not in b:
                yield _change("removed", (*path, str(key)), a[key], None)
            elif key not in a:
                yield _change("added", (*path, str(key)), None, b[key])
            else:
                yield from changed_keys(a[key], b[key], (*path, str(key)))
        return
    if isinstance(a, list) and isinstance(b, list) and path[-1:] and path[-1] in _LISTS:
        pairs = _match_items(a, b)
        for old, new in moved(pairs):
            was, now = (format_path((*path, place)) for place in (old, new))
            yield KeyChange(change="moved", path=now, before=was, after=now)
        for i, j in pairs:
            if j is None:
                yield _change("removed", (*path, i or 0), a[i or 0], None)
            elif i is None:
                yield _change("added", (*path, j), None, b[j])
            else:
                yield from changed_keys(a[i], b[j], (*path, j))
        return
    if not same(a, b):
        yield _change("changed", path, a, b)


def place(change: str, path: str) -> str:
    """The path of a change as the summary names it; the index of a removed list item is one of the former file."""
    return f"former {path}" if change == "removed" and path.endswith("]") else path


def _change(kind: Any, path: Path, before: Any, after: Any) -> KeyChange:
    return KeyChange(change=kind, path=format_path(path), before=_json(before), after=_json(after))


def _json(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _json(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_json(item) for item in value]
    return value if value is None or isinstance(value, (bool, int, float, str)) else str(value)


def same(a: Any, b: Any) -> bool:
    """Whether two values mean the same: 1 and 1.0 do, 1 and true do not."""
    if isinstance(a, bool) != isinstance(b, bool):
        return False
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        return a == b or (a != a and b != b)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(same, a, b))
    return type(a) is type(b) and bool(a == b)


def entry_pairs(a: Document, b: Document) -> dict[str, Pairs]:
    """Matching entries of two documents, by section."""
    old, new = data_of(a), data_of(b)
    return {role: _match_items(_entries(old, role), _entries(new, role)) for role in ("robot", "obstacle")}


def _entries(data: Any, role: str) -> list[Any]:
    entries = data.get(role) if isinstance(data, Mapping) else None
    return entries if isinstance(entries, list) else []


def _match_items(a: Sequence[Any], b: Sequence[Any]) -> Pairs:
    """Match equal items first, then items with the same name, then the most similar ones."""
    left, right = list(range(len(a))), list(range(len(b)))
    pairs: Pairs = []

    def take(i: int, j: int) -> None:
        pairs.append((i, j))
        left.remove(i)
        right.remove(j)

    for block in difflib.SequenceMatcher(
        None, [_canonical_text(x) for x in a], [_canonical_text(x) for x in b], False
    ).get_matching_blocks():
        for k in range(block.size):
            take(block.a + k, block.b + k)
    for i in list(left):
        name = _name_of(a[i])
        twin = next((j for j in right if name is not None and _name_of(b[j]) == name), None)
        if twin is not None:
            take(i, twin)
    few = len(left) * len(right) <= _MAX_CANDIDATES
    candidates = [(i, j) for i in left for j in right] if few else list(zip(left, right, strict=False))
    of_a, of_b = ({k: set(_leaves(items[k])) for k in rest} for items, rest in ((a, left), (b, right)))
    alike = [(-_likeness(of_a[i], of_b[j]), abs(i - j), i, j) for i, j in candidates]
    for score, _, i, j in sorted(alike):
        if -score >= _MIN_LIKENESS and i in left and j in right:
            take(i, j)
    if len(left) == len(right) == 1:
        take(left[0], right[0])
    rest: Pairs = [*((i, None) for i in left), *((None, j) for j in right)]
    return sorted([*pairs, *rest], key=lambda pair: (pair[1] if pair[1] is not None else pair[0] or 0, pair[1] is None))


def moved(pairs: Sequence[tuple[int | None, int | None]]) -> list[tuple[int, int]]:
    """Fewest pairs of indices that must be left out so that the other pairs are in order on both sides.

    Args:
        pairs: Pairs of indices, sorted by the second.
    """
    both = [(i, j) for i, j in pairs if i is not None and j is not None]
    ends: list[int] = []  # the least last value of an increasing subsequence of each length
    length = []
    for i, _ in both:
        at = bisect.bisect_left(ends, i)
        ends[at : at + 1] = [i]
        length.append(at)
    wanted, moved, bound = len(ends) - 1, list[tuple[int, int]](), float("inf")
    for (i, j), at in zip(reversed(both), reversed(length), strict=True):
        if at == wanted and i < bound:
            wanted, bound = wanted - 1, i
        else:
            moved.append((i, j))
    return moved[::-1]


def _name_of(item: Any) -> str | None:
    name = item.get("name") if isinstance(item, Mapping) else None
    return name if isinstance(name, str) else None


def _likeness(a: set[tuple[str, str]], b: set[tuple[str, str]]) -> float:
    """Share of the leaves of two items that both have, 0 to 1."""
    return len(a & b) / max(1, len(a | b))


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _leaves(item, f"{path}.{key}")
    else:
        yield path, _canonical_text(value)


def _canonical_text(value: Any) -> str:
    """A text that is the same for equal values, in whatever order their keys are, and for 1 and 1.0."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(sorted(f"{key!r}: {_canonical_text(item)}" for key, item in value.items())) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_canonical_text, value)) + "]"
    return repr(int(value)) if isinstance(value, float) and value.is_integer() else repr(value)
