"""Differences between the worlds built from two scenarios, by object."""

from __future__ import annotations

import json
import re
from collections import Counter, defaultdict, deque
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from irsim.common.arguments import is_number
from irsim.env import Env
from irsim.results.validation import KeyChange, WorldChange
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.validation.diff.keys import Pairs, moved, same
from irsim.validation.diff.world_facts import describe_world

__all__ = ["changed_worlds", "differing", "listed"]

_BEHAVIORS = ("behavior", "group_behavior")
_WRITTEN = {
    "pose": ("state",),
    "goals": ("goal",),
    "wheelbase": ("wheelbase", "kinematics.wheelbase", "shape.wheelbase"),
    **{
        key: tuple(f"{behavior}.{key}" for behavior in _BEHAVIORS)
        for key in ("wander", "loop", "range_low", "range_high", "target_roles")
    },
}
"""Scenario keys that determine a property with another name."""


def changed_worlds(
    a: ResolvedScenario, b: ResolvedScenario, pairs: Mapping[str, Pairs], seed: int | None, keys: Sequence[KeyChange]
) -> list[WorldChange]:
    """Compare the worlds built from two scenarios.

    Args:
        a: The first scenario.
        b: The second scenario.
        pairs: Matching entries of the files, by section.
        seed: Seed with which both worlds are built; None: the scenario's own, else 0.
        keys: Differences between the files; changes that only repeat one of them are marked ``direct``.

    Raises:
        PlacementError: There is no free place for a random object.
    """
    old, new = _described(a, seed), _described(b, seed)
    changes = [
        WorldChange(object=None, change="changed", key=k, before=was, after=now, direct=_direct("world", k, now, keys))
        for k, was, now in differing(old["world"], new["world"])
    ]
    twins = match_objects(old["objects"], new["objects"], pairs)
    removed = set(range(len(old["objects"]))) - {i for i, _ in twins}
    added = set(range(len(new["objects"]))) - {j for _, j in twins}
    single = _single_object_entries(old["objects"], "removed", keys)
    for i in sorted(removed):
        item = old["objects"][i]
        direct = listed(item["entry"]) in single
        changes.append(WorldChange(object=item["name"], change="removed", before=_brief(item), direct=direct))
    single = _single_object_entries(new["objects"], "added", keys)
    for j in sorted(added):
        item = new["objects"][j]
        direct = listed(item["entry"]) in single
        changes.append(WorldChange(object=item["name"], change="added", after=_brief(item), direct=direct))
    twins.sort(key=lambda pair: pair[1])
    changes += [
        WorldChange(
            object=new["objects"][j]["name"],
            change="changed",
            key="number",
            before=i,
            after=j,
            direct=any(key.change == "moved" for key in keys),
        )
        for i, j in moved(twins)
    ]
    about = defaultdict[str, list[KeyChange]](list)
    for key in keys:
        about[_entry_of(key.path)].append(key)
    same = dict(twins)
    for i, j in twins:
        name, entry = new["objects"][j]["name"], listed(new["objects"][j]["entry"])
        written = [*about[entry], *about[entry.partition("[")[0]]]
        facts = list(object_facts(old["objects"][i], new["objects"][j]))
        if not any(key == "group_behavior" for key, _, _ in facts):
            facts += _changed_group(old["objects"], new["objects"], i, j, same)
        changes += [
            WorldChange(
                object=name, change="changed", key=k, before=was, after=now, direct=_direct(entry, k, now, written)
            )
            for k, was, now in facts
        ]
    return changes


def _entry_of(path: str) -> str:
    """The entry that contains a path, or the path itself if it is a section."""
    return path.partition(".")[0]


def _changed_group(
    old: Sequence[Mapping[str, Any]], new: Sequence[Mapping[str, Any]], i: int, j: int, twins: Mapping[int, int]
) -> Iterator[tuple[str, Any, Any]]:
    """The members of an object's group behavior before and after, if fewer than half of them are the same."""
    before = old[i].get("group_members") or []
    after = new[j].get("group_members") or []
    if not before and not after:
        return
    was = {twins[k] for k in before if k in twins} - {j}
    now = set(after) & set(twins.values()) - {j}
    if 2 * len(was & now) < len(was | now):
        yield "group_members", [old[k]["name"] for k in before], [new[k]["name"] for k in after]


def _direct(entry: str, fact: str, now: Any, keys: Sequence[KeyChange]) -> bool:
    """Whether the change of a property only repeats the change of a key."""
    root = re.split(r"[.\[]", fact, maxsplit=1)[0]
    for written in _WRITTEN.get(root, (root,)):
        place = f"{entry}.{written}{fact[len(root) :]}"
        for key in keys:
            if key.change not in ("removed", "moved") and key.path == place:
                return _agrees(key.after, now)
            if key.path.startswith((f"{place}.", f"{place}[")):  # a part of the property was written
                return True
            if key.path == entry:  # the file has a new entry for an object that was there before
                continue
            if key.change not in ("removed", "moved") and place.startswith((f"{key.path}.", f"{key.path}[")):
                return True
    return False


def _agrees(written: Any, fact: Any) -> bool:
    """Whether a property begins with the numbers that were written; values without numbers always agree."""
    if isinstance(written, list) and written and all(isinstance(item, list) for item in written):
        return isinstance(fact, list) and len(fact) == len(written) and all(map(_agrees, written, fact))
    ours, theirs = list(_numbers(written)), list(_numbers(fact))
    if not ours or not theirs:
        return True
    return len(ours) <= len(theirs) and all(abs(x - y) <= 1e-6 for x, y in zip(ours, theirs, strict=False))


def _numbers(value: Any) -> Iterator[float]:
    if isinstance(value, list):
        for item in value:
            yield from _numbers(item)
    elif is_number(value):
        yield float(value)


def _single_object_entries(objects: Sequence[Any], change: str, keys: Sequence[KeyChange]) -> set[str]:
    """Entries that were added or removed and that describe a single object."""
    changed = {key.path for key in keys if key.change == change}
    count = Counter(listed(item["entry"]) for item in objects)
    return {entry for entry in changed if count[entry] == 1}


def _described(scenario: ResolvedScenario, seed: int | None) -> dict[str, Any]:
    if seed is None:
        seed = scenario.world.seed if scenario.world.seed is not None else 0
    env = Env(scenario, seed=seed, display=False, headless=True, log_level="ERROR")
    try:
        simulation = env.simulation
        for row in np.flatnonzero(simulation.appeared < 0).tolist():  # objects that come later are described there, too
            simulation.pose[row] = simulation.state.initial_state(row)[:3]
        simulation.refresh()
        return describe_world(env)
    finally:
        env.end(ending_time=0.0)


def _brief(item: Mapping[str, Any]) -> dict[str, Any]:
    """The main properties of an object that was added or removed."""
    brief = {"role": item["role"], "shape": item["shape"]["name"], "pose": item["pose"]}
    if item["goals"]:
        brief["goals"] = item["goals"]
    for key in ("kinematics", "behavior"):
        if item.get(key):
            brief[key] = item[key]["name"]
    return brief


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
    places = {
        f"{role}[{i}]": f"{role}[{j}]" for role, matched in pairs.items() for i, j in matched if None not in (i, j)
    }
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
    facts = list(differing(before, after))
    if a["name"] != b["name"] and not (_NUMBERED.match(a["name"]) and _NUMBERED.match(b["name"])):
        facts.insert(0, ("name", a["name"], b["name"]))
    explained = any(key.partition(".")[0] in ("pose", "shape", "wheelbase") for key, _, _ in facts)
    yield from (fact for fact in facts if not (explained and fact[0].startswith("footprint")))


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
