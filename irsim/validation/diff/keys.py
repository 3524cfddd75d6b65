"""What differs between the data of two files, by key."""

from __future__ import annotations

import bisect
import difflib
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from irsim.diagnostics.diagnostic import Path, format_path
from irsim.results.diff import KeyChange

if TYPE_CHECKING:
    from irsim.scenario.yaml.document import Document

__all__ = ["Pairs", "changed_keys", "data_of", "entry_pairs", "moved", "place", "same"]

_LISTS = ("robot", "obstacle", "sensors", "sensor", "parts")
"""Keys whose lists hold things that are recognised again when others come or go before them."""
_ALIKE, _MANY = 0.34, 10_000
"""Share of leaves of items that belong together; pairs that are looked at: of more, only those in order."""

Pairs = list[tuple[int | None, int | None]]


def data_of(document: Document) -> Any:
    """The data, with a single robot or obstacle as a list of one, which means the same."""
    data = document.data
    if not isinstance(data, Mapping):
        return data
    return {
        key: [value] if key in ("robot", "obstacle") and isinstance(value, Mapping) else value
        for key, value in data.items()
    }


def changed_keys(a: Any, b: Any, path: Path) -> Iterator[KeyChange]:
    """Changes of the data, where it was (removed) or where it is now."""
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
        pairs = _aligned(a, b)
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
    """The path of a change, in words that say so where its number is that of the file before."""
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
    """Which entries of the two belong together, by section."""
    old, new = data_of(a), data_of(b)
    return {role: _aligned(_entries(old, role), _entries(new, role)) for role in ("robot", "obstacle")}


def _entries(data: Any, role: str) -> list[Any]:
    entries = data.get(role) if isinstance(data, Mapping) else None
    return entries if isinstance(entries, list) else []


def _aligned(a: Sequence[Any], b: Sequence[Any]) -> Pairs:
    """Pairs of indices: equal items, items of one name, then the most alike; those left over stand alone."""
    left, right = list(range(len(a))), list(range(len(b)))
    pairs: Pairs = []

    def take(i: int, j: int) -> None:
        pairs.append((i, j))
        left.remove(i)
        right.remove(j)

    for block in difflib.SequenceMatcher(
        None, [_told(x) for x in a], [_told(x) for x in b], False
    ).get_matching_blocks():
        for k in range(block.size):
            take(block.a + k, block.b + k)
    for i in list(left):
        name = _name_of(a[i])
        twin = next((j for j in right if name is not None and _name_of(b[j]) == name), None)
        if twin is not None:
            take(i, twin)
    few = len(left) * len(right) <= _MANY
    candidates = [(i, j) for i in left for j in right] if few else list(zip(left, right, strict=False))
    of_a, of_b = ({k: set(_leaves(items[k])) for k in rest} for items, rest in ((a, left), (b, right)))
    alike = [(-_likeness(of_a[i], of_b[j]), abs(i - j), i, j) for i, j in candidates]
    for score, _, i, j in sorted(alike):
        if -score >= _ALIKE and i in left and j in right:
            take(i, j)
    if len(left) == len(right) == 1:
        take(left[0], right[0])
    rest: Pairs = [*((i, None) for i in left), *((None, j) for j in right)]
    return sorted([*pairs, *rest], key=lambda pair: (pair[1] if pair[1] is not None else pair[0] or 0, pair[1] is None))


def moved(pairs: Sequence[tuple[int | None, int | None]]) -> list[tuple[int, int]]:
    """Of pairs of places, sorted by the second, as few as possible without which the first are in order, too."""
    both = [(i, j) for i, j in pairs if i is not None and j is not None]
    ends: list[int] = []  # the least end of a run of each length
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
    """Share of leaves that two items have in common, 0 to 1."""
    return len(a & b) / max(1, len(a | b))


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _leaves(item, f"{path}.{key}")
    else:
        yield path, _told(value)


def _told(value: Any) -> str:
    """One text for all that is the same: in whatever order keys are, 1 or 1.0."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(sorted(f"{key!r}: {_told(item)}" for key, item in value.items())) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_told, value)) + "]"
    return repr(int(value)) if isinstance(value, float) and value.is_integer() else repr(value)
