"""Match the objects of two worlds, and list the properties in which two objects differ."""

from __future__ import annotations

import json
import re
from collections import defaultdict, deque
from collections.abc import Callable, Hashable, Iterator, Mapping
from typing import Any

from irsim.validation.diff.keys import Pairs, same

__all__ = ["differing", "listed", "match_objects", "object_facts"]

_SHIFTING = ("name", "entry", "index", "group", "group_members")
"""Keys of an object's description whose values shift when other objects come or go."""
_MAX_DIFFERENCES = 2
"""Largest number of differing properties of two objects that are matched by neither name nor entry."""
_MAX_CANDIDATES = 2_500
"""Largest number of pairs of unmatched objects whose properties are compared."""
_NUMBERED = re.compile(r"(robot|obstacle)_\d+\Z")
"""Names that objects get by default."""


def match_objects(
    a: list[dict[str, Any]], b: list[dict[str, Any]], pairs: Mapping[str, Pairs]
) -> list[tuple[int, int]]:
    """Match the objects of two worlds, whatever entries they are written in.

    Objects match, in this order, if they have the same name of their own, if they are equal, if they have the same
    number in matching entries, or if they differ in few properties.

    Args:
        a: Descriptions of the objects of one world.
        b: Descriptions of the objects of the other.
        pairs: Matching entries of the files, by section.

    Returns:
        Pairs of indices in ``a`` and ``b``, sorted by the first.
    """
    places = {f"{role}[{i}]": f"{role}[{j}]" for role, found in pairs.items() for i, j in found if None not in (i, j)}
    left, right = dict.fromkeys(range(len(a))), dict.fromkeys(range(len(b)))
    twins = []

    def take(of_a: Callable[[Any], Hashable], of_b: Callable[[Any], Hashable]) -> None:
        """Match objects with the same key, in order; objects whose key is None stay unmatched."""
        there = defaultdict[Hashable, deque[int]](deque)
        for j in right:
            there[of_b(b[j])].append(j)
        for i in list(left):
            key = of_a(a[i])
            if key is not None and there[key]:
                j = there[key].popleft()
                twins.append((i, j))
                del left[i], right[j]

    facts = {id(item): _facts(item) for item in (*a, *b)}

    def place_in_b(item: Any) -> Hashable:
        entry = listed(item["entry"])
        return (places[entry], item["index"]) if entry in places else None

    def place(item: Any) -> Hashable:
        return listed(item["entry"]), item["index"]

    take(_written_name, _written_name)
    take(lambda item: (place_in_b(item), facts[id(item)]), lambda item: (place(item), facts[id(item)]))
    take(lambda item: (item["name"], facts[id(item)]), lambda item: (item["name"], facts[id(item)]))
    take(lambda item: facts[id(item)], lambda item: facts[id(item)])
    take(place_in_b, place)
    if len(left) * len(right) <= _MAX_CANDIDATES:
        alike = sorted(
            (different, a[i]["name"] != b[j]["name"], i, j)
            for i in left
            for j in right
            if (different := _count_differences(a[i], b[j])) <= _MAX_DIFFERENCES
        )
        for _, _, i, j in alike:
            if i in left and j in right:
                twins.append((i, j))
                del left[i], right[j]
    return sorted(twins)


def _written_name(item: Mapping[str, Any]) -> Hashable:
    """The name that the scenario gives an object, None for a default name; map and walls go by their entry."""
    if item["entry"].startswith("world"):
        return str(item["entry"])
    return None if _NUMBERED.match(item["name"]) else (item["role"], item["name"])


def _facts(item: Mapping[str, Any]) -> str:
    """All properties of an object that do not depend on its number, as text."""
    shown = {key: value for key, value in item.items() if key not in _SHIFTING}
    return json.dumps([_written_name(item), shown], sort_keys=True)


def _count_differences(a: Mapping[str, Any], b: Mapping[str, Any]) -> float:
    """Number of keys that differ; infinity for objects with different roles or different written names."""
    names = _written_name(a), _written_name(b)
    if a["role"] != b["role"] or (None not in names and names[0] != names[1]):
        return float("inf")
    return len({re.split(r"[.\[]", key, maxsplit=1)[0] for key, _, _ in object_facts(a, b)})


def object_facts(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[tuple[str, Any, Any]]:
    """Properties that differ between two objects; the footprint only if no other difference explains it."""
    before, after = ({key: value for key, value in item.items() if key not in _SHIFTING} for item in (a, b))
    found = list(differing(before, after))
    if a["name"] != b["name"] and not (_NUMBERED.match(a["name"]) and _NUMBERED.match(b["name"])):
        found.insert(0, ("name", a["name"], b["name"]))
    explained = any(key.partition(".")[0] in ("pose", "shape", "wheelbase") for key, _, _ in found)
    yield from (fact for fact in found if not (explained and fact[0].startswith("footprint")))


def differing(a: Any, b: Any, key: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Key and both values of each property that differs; a list of numbers is one property."""
    if isinstance(a, Mapping) and isinstance(b, Mapping) and a.get("name") == b.get("name"):
        for name in dict.fromkeys([*a, *b]):
            yield from differing(a.get(name), b.get(name), f"{key}.{name}" if key else str(name))
        return
    if (
        isinstance(a, list)
        and isinstance(b, list)
        and len(a) == len(b)
        and all(isinstance(x, Mapping) for x in [*a, *b])
    ):
        for index, (x, y) in enumerate(zip(a, b, strict=True)):
            yield from differing(x, y, f"{key}[{index}]")
        return
    if not same(a, b) and a != b:
        yield key, a, b


def listed(entry: str) -> str:
    """The path of an entry in a list; a single robot or obstacle counts as a list of one."""
    return f"{entry}[0]" if entry in ("robot", "obstacle") else entry
