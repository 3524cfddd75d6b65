"""What differs between two scenarios: in the files, by key, and in the worlds they become, by object."""

from __future__ import annotations

import bisect
import difflib
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from irsim.description import describe_world
from irsim.diagnostics import Path, format_path
from irsim.env import Env
from irsim.errors import PlacementError
from irsim.results import CommentChange, KeyChange, ScenarioDiff, WorldChange
from irsim.scenario.comments import comments
from irsim.scenario.load import Document
from irsim.scenario.objects import ResolvedScenario
from irsim.scenario.read import Reading

__all__ = ["compare"]

_LISTS = ("robot", "obstacle", "sensors", "sensor", "parts")
"""Keys whose lists hold things that are recognised again when others come or go before them."""
_ALIKE = 0.34
_SHIFTING = ("name", "entry", "index", "group", "group_members")
"""Of an object's description: numbers and names that shift when others come or go."""
_NUMBERED = re.compile(r"(robot|obstacle)_\d+\Z")
_NAMED = 6
_EDITED = 0.5
"""Comments that are more alike than that are one that was edited."""
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
"""Keys that a fact is written with, where they are called otherwise."""

Pairs = list[tuple[int | None, int | None]]


def compare(a: Reading, b: Reading, *, seed: int | None = None) -> ScenarioDiff:
    """Compare two scenarios that have been read.

    Args:
        a: The one before.
        b: The one after.
        seed: Both worlds are built with it; default: the scenario's own, else 0.
    """
    keys = list(_keys(_data(a.document), _data(b.document), ()))
    worlds, why = None, "one of the scenarios is invalid"
    if a.scenario is not None and b.scenario is not None:
        try:
            worlds = _worlds(a.scenario, b.scenario, _entry_pairs(a.document, b.document), seed, keys)
        except PlacementError as error:
            why = error.diagnostics[0].message
    lines = _lines(a.document.text, b.document.text)
    lost, edited = _comments_gone(a.document.text, b.document.text)
    there = bool(comments(a.document.text or ""))
    return ScenarioDiff(
        before=a.document.name or "(text)",
        after=b.document.name or "(text)",
        same=not keys and not worlds,
        summary=_summary(keys, worlds, why, _comments_told(there, lost, edited)),
        keys=keys,
        world=worlds,
        comments_lost=lost,
        comments_changed=edited,
        lines_removed=lines[0],
        lines_added=lines[1],
    )


def _data(document: Document) -> Any:
    """The data, with a single robot or obstacle as a list of one, which means the same."""
    data = document.data
    if not isinstance(data, Mapping):
        return data
    return {
        key: [value] if key in ("robot", "obstacle") and isinstance(value, Mapping) else value
        for key, value in data.items()
    }


# keys -----------------------------------------------------------------------------------------------------------------


def _keys(a: Any, b: Any, path: Path) -> Iterator[KeyChange]:
    """Changes of the data, where it was (removed) or where it is now."""
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        for key in dict.fromkeys([*a, *b]):
            if key not in b:
                yield _change("removed", (*path, str(key)), a[key], None)
            elif key not in a:
                yield _change("added", (*path, str(key)), None, b[key])
            else:
                yield from _keys(a[key], b[key], (*path, str(key)))
        return
    if isinstance(a, list) and isinstance(b, list) and path[-1:] and path[-1] in _LISTS:
        pairs = _aligned(a, b)
        for old, new in _moved(pairs):
            was, now = (format_path((*path, place)) for place in (old, new))
            yield KeyChange(change="moved", path=now, before=was, after=now)
        for i, j in pairs:
            if j is None:
                yield _change("removed", (*path, i or 0), a[i or 0], None)
            elif i is None:
                yield _change("added", (*path, j), None, b[j])
            else:
                yield from _keys(a[i], b[j], (*path, j))
        return
    if not _same(a, b):
        yield _change("changed", path, a, b)


def _change(kind: Any, path: Path, before: Any, after: Any) -> KeyChange:
    return KeyChange(change=kind, path=format_path(path), before=_json(before), after=_json(after))


def _json(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _json(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_json(item) for item in value]
    return value if value is None or isinstance(value, (bool, int, float, str)) else str(value)


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, bool) != isinstance(b, bool):
        return False
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        return a == b or (a != a and b != b)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(_same, a, b))
    return type(a) is type(b) and bool(a == b)


def _entry_pairs(a: Document, b: Document) -> dict[str, Pairs]:
    """Which entries of the two belong together, by section."""
    old, new = _data(a), _data(b)
    return {
        role: _aligned(*(data.get(role) or [] if isinstance(data, Mapping) else [] for data in (old, new)))
        for role in ("robot", "obstacle")
    }


def _aligned(a: Sequence[Any], b: Sequence[Any]) -> Pairs:
    """Pairs of indices: equal items, items of one name, then the most alike; those left over stand alone."""
    left, right = list(range(len(a))), list(range(len(b)))
    pairs: Pairs = []

    def take(i: int, j: int) -> None:
        pairs.append((i, j))
        left.remove(i)
        right.remove(j)

    for block in difflib.SequenceMatcher(None, [repr(x) for x in a], [repr(x) for x in b], False).get_matching_blocks():
        for k in range(block.size):
            take(block.a + k, block.b + k)
    for i in list(left):
        name = _name_of(a[i])
        twin = next((j for j in right if name is not None and _name_of(b[j]) == name), None)
        if twin is not None:
            take(i, twin)
    few = len(left) * len(right) <= 10_000
    alike = [(-_likeness(a[i], b[j]), abs(i - j), i, j) for i in left for j in right] if few else []
    for score, _, i, j in sorted(alike):
        if -score >= _ALIKE and i in left and j in right:
            take(i, j)
    if len(left) == len(right) == 1:
        take(left[0], right[0])
    rest: Pairs = [*((i, None) for i in left), *((None, j) for j in right)]
    return sorted([*pairs, *rest], key=lambda pair: (pair[1] if pair[1] is not None else pair[0] or 0, pair[1] is None))


def _moved(pairs: Sequence[tuple[int | None, int | None]]) -> list[tuple[int, int]]:
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


def _likeness(a: Any, b: Any) -> float:
    """Share of leaves that two items have in common, 0 to 1."""
    ours, theirs = set(_leaves(a)), set(_leaves(b))
    return len(ours & theirs) / max(1, len(ours | theirs))


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _leaves(item, f"{path}.{key}")
    else:
        yield path, repr(value)


# worlds ---------------------------------------------------------------------------------------------------------------


def _worlds(
    a: ResolvedScenario,
    b: ResolvedScenario,
    pairs: Mapping[str, Pairs],
    seed: int | None,
    keys: Sequence[KeyChange],
) -> list[WorldChange]:
    old, new = _described(a, seed), _described(b, seed)
    changes = [
        WorldChange(object=None, change="changed", key=k, before=was, after=now, direct=_direct("world", k, now, keys))
        for k, was, now in _facts(old["world"], new["world"], "")
    ]
    twins = _twins(old["objects"], new["objects"], pairs)
    gone = set(range(len(old["objects"]))) - {i for i, _ in twins}
    come = set(range(len(new["objects"]))) - {j for _, j in twins}
    for i in sorted(gone):
        item = old["objects"][i]
        direct = _alone(item, "removed", old["objects"], keys)
        changes.append(WorldChange(object=item["name"], change="removed", before=_brief(item), direct=direct))
    for j in sorted(come):
        item = new["objects"][j]
        direct = _alone(item, "added", new["objects"], keys)
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
        for i, j in _moved(twins)
    ]
    for i, j in twins:
        name, entry = new["objects"][j]["name"], _listed(new["objects"][j]["entry"])
        facts = list(_object_facts(old["objects"][i], new["objects"][j]))
        if not any(key == "group_behavior" for key, _, _ in facts):
            facts += _company(old["objects"], new["objects"], i, j, dict(twins))
        changes += [
            WorldChange(
                object=name, change="changed", key=k, before=was, after=now, direct=_direct(entry, k, now, keys)
            )
            for k, was, now in facts
        ]
    return changes


def _company(
    old: Sequence[Mapping[str, Any]], new: Sequence[Mapping[str, Any]], i: int, j: int, twins: Mapping[int, int]
) -> Iterator[tuple[str, Any, Any]]:
    """That an object is led by a group behavior with others than before: most of those in both worlds."""
    before = old[i].get("group_members") or []
    after = new[j].get("group_members") or []
    there = set(twins.values())
    was = {twins[k] for k in before if k in twins} - {j}
    now = {k for k in after if k in there} - {j}
    if 2 * len(was & now) < len(was | now):
        yield "group_members", [old[k]["name"] for k in before], [new[k]["name"] for k in after]


def _direct(entry: str, fact: str, now: Any, keys: Sequence[KeyChange]) -> bool:
    """Whether a fact only repeats a key that was written."""
    root = re.split(r"[.\[]", fact, maxsplit=1)[0]
    for written in _WRITTEN.get(root, (root,)):
        place = f"{entry}.{written}{fact[len(root) :]}"
        for key in keys:
            if key.change not in ("removed", "moved") and key.path == place:
                return _says(key.after, now)
            if key.path.startswith((f"{place}.", f"{place}[")):  # a part of what is told as a whole
                return True
            if key.change not in ("removed", "moved") and place.startswith((f"{key.path}.", f"{key.path}[")):
                return True
    return False


def _says(written: Any, fact: Any) -> bool:
    """Whether a fact has the numbers that were written first; other things are what was written."""
    if isinstance(written, list) and written and all(isinstance(item, list) for item in written):
        return isinstance(fact, list) and len(fact) == len(written) and all(map(_says, written, fact))
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


def _alone(item: Mapping[str, Any], change: str, objects: Sequence[Any], keys: Sequence[KeyChange]) -> bool:
    """Whether an object that came or went is all that an entry stands for."""
    entry = _listed(item["entry"])
    told = any((key.change, key.path) == (change, entry) for key in keys)
    return told and sum(_listed(other["entry"]) == entry for other in objects) == 1


def _described(scenario: ResolvedScenario, seed: int | None) -> dict[str, Any]:
    if seed is None:
        seed = scenario.world.seed if scenario.world.seed is not None else 0
    env = Env(scenario, seed=seed, display=False, headless=True, log_level="ERROR")
    try:
        return describe_world(env)
    finally:
        env.end(ending_time=0.0)


def _twins(a: list[dict[str, Any]], b: list[dict[str, Any]], pairs: Mapping[str, Pairs]) -> list[tuple[int, int]]:
    """Objects of entries that belong together, by their number in the entry; the map and the walls with their like."""
    places = {f"{role}[{i}]": f"{role}[{j}]" for role, found in pairs.items() for i, j in found if None not in (i, j)}
    there = {(_listed(item["entry"]), item["index"]): number for number, item in enumerate(b)}
    found_pairs = []
    for number, item in enumerate(a):
        entry = _listed(item["entry"])
        twin = there.get((places.get(entry, entry if entry.startswith("world") else ""), item["index"]))
        if twin is not None:
            found_pairs.append((number, twin))
    return found_pairs


def _listed(entry: str) -> str:
    return f"{entry}[0]" if entry in ("robot", "obstacle") else entry


def _facts(a: Any, b: Any, key: str) -> Iterator[tuple[str, Any, Any]]:
    """Facts that differ; lists of numbers are one fact."""
    if isinstance(a, Mapping) and isinstance(b, Mapping) and a.get("name") == b.get("name"):
        for name in dict.fromkeys([*a, *b]):
            yield from _facts(a.get(name), b.get(name), f"{key}.{name}" if key else str(name))
        return
    if (
        isinstance(a, list)
        and isinstance(b, list)
        and len(a) == len(b)
        and all(isinstance(x, Mapping) for x in [*a, *b])
    ):
        for index, (x, y) in enumerate(zip(a, b, strict=True)):
            yield from _facts(x, y, f"{key}[{index}]")
        return
    if not _same(a, b) and a != b:
        yield key, a, b


def _object_facts(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[tuple[str, Any, Any]]:
    """Facts that differ between two objects; a footprint only if no other fact explains it."""
    before, after = ({key: value for key, value in item.items() if key not in _SHIFTING} for item in (a, b))
    found = list(_facts(before, after, ""))
    if a["name"] != b["name"] and not (_NUMBERED.match(a["name"]) and _NUMBERED.match(b["name"])):
        found.insert(0, ("name", a["name"], b["name"]))
    explained = any(key.partition(".")[0] in ("pose", "shape", "wheelbase") for key, _, _ in found)
    yield from (fact for fact in found if not (explained and fact[0].startswith("footprint")))


def _brief(item: Mapping[str, Any]) -> dict[str, Any]:
    """What one would say of an object that came or went."""
    brief = {"role": item["role"], "shape": item["shape"]["name"], "pose": item["pose"]}
    if item["goals"]:
        brief["goals"] = item["goals"]
    for key in ("kinematics", "behavior"):
        if item.get(key):
            brief[key] = item[key]["name"]
    return brief


# text -----------------------------------------------------------------------------------------------------------------


def _lines(a: str | None, b: str | None) -> tuple[int, int]:
    if a is None or b is None:
        return 0, 0
    found = list(difflib.unified_diff(a.splitlines(), b.splitlines(), lineterm="", n=0))[2:]
    return sum(line.startswith("-") for line in found), sum(line.startswith("+") for line in found)


def _comments_gone(a: str | None, b: str | None) -> tuple[list[str], list[CommentChange]]:
    """Comments that are gone, and those that say something else now."""
    if a is None or b is None:
        return [], []
    left = comments(b)
    gone = []
    for comment in comments(a):
        if comment in left:
            left.remove(comment)
        else:
            gone.append(comment)
    lost, edited = [], []
    few = len(gone) * len(left) <= 1_000
    for comment in gone:
        alike = {new: difflib.SequenceMatcher(None, comment, new, False).ratio() for new in left} if few else {}
        twin = max(alike, key=lambda new: alike[new], default=None)
        if twin is None or alike[twin] <= _EDITED:
            lost.append(comment)
        else:
            left.remove(twin)
            edited.append(CommentChange(before=comment, after=twin))
    return lost, edited


def _comments_told(there: bool, lost: Sequence[str], edited: Sequence[CommentChange]) -> str:
    """What became of the comments, in words; empty if there were none."""
    told = [
        f"{len(found)} comment{'s' * (len(found) != 1)} {what}"
        for what, found in (("lost", lost), ("changed", edited))
        if found
    ]
    if there and not lost:
        told.insert(0, "no comment lost")
    return ", ".join(told)


def _summary(keys: Sequence[KeyChange], world: Sequence[WorldChange] | None, why: str, comments: str) -> str:
    moved = [change for change in keys if change.change == "moved"]
    written = [change for change in keys if change.change != "moved"]
    if not written:
        text = "no key differs but for the order" if moved else "no key differs"
    else:
        named = ", ".join(change.path for change in written[:_NAMED])
        more = f" and {len(written) - _NAMED} more" if len(written) > _NAMED else ""
        text = f"{len(written)} key{'s' * (len(written) != 1)} differ{'s' * (len(written) == 1)}: {named}{more}"
    if moved:
        told = ", ".join(f"{change.before} is now {change.after}" for change in moved[:_NAMED])
        text += f"{'; the order differs' * bool(written)}: {told}"
        text += f" and {len(moved) - _NAMED} more" if len(moved) > _NAMED else ""
        if any(change.path.startswith(("robot[", "obstacle[")) and change.path.count("[") == 1 for change in moved):
            text += ", which changes ids and labels"
        if any(change.path.startswith("robot[") and change.path.count("[") == 1 for change in moved):
            text += " and which robot env.step(action) drives"
    if world is None:
        text += f"; the worlds are not compared: {why}"
    else:
        further = list(dict.fromkeys(change.object or "the world" for change in world if not change.direct))
        named = ", ".join(further[:_NAMED]) + (f" and {len(further) - _NAMED} more" if len(further) > _NAMED else "")
        if further:
            text += f"; which also changes {named}" if keys else f"; in the world: {named}"
        elif not world:
            text += "; the worlds are the same"
    return text + (f"; {comments}" if comments else "")
