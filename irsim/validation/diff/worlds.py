"""Differences between the worlds built from two scenarios, by object."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from irsim.env import Env
from irsim.results.diff import KeyChange, WorldChange
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.validation.diff.keys import Pairs, moved
from irsim.validation.diff.matching import differing, listed, match_objects, object_facts
from irsim.validation.diff.world_facts import describe_world

__all__ = ["changed_worlds"]

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
    a: ResolvedScenario,
    b: ResolvedScenario,
    pairs: Mapping[str, Pairs],
    seed: int | None,
    keys: Sequence[KeyChange],
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
        found = list(object_facts(old["objects"][i], new["objects"][j]))
        if not any(key == "group_behavior" for key, _, _ in found):
            found += _changed_group(old["objects"], new["objects"], i, j, same)
        changes += [
            WorldChange(
                object=name, change="changed", key=k, before=was, after=now, direct=_direct(entry, k, now, written)
            )
            for k, was, now in found
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
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
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
