"""What differs between two texts: lines and comments."""

from __future__ import annotations

import difflib
from collections import defaultdict
from collections.abc import Mapping, Sequence

from irsim.diagnostics.diagnostic import Path
from irsim.results.diff import CommentChange
from irsim.scenario.yaml.comments import places_of_comments
from irsim.scenario.yaml.document import Document
from irsim.validation.diff.keys import Pairs

__all__ = ["changed_comments", "changed_lines", "comments_told"]

_EDITED = 0.5
"""Comments that are more alike than that are one that was edited, whatever they are about."""
_MANY, _NEAR = 1_000, 100
"""Pairs, and equal comments, that are looked at."""

Comment = tuple[str, set[Path]]
"""Its text, and the paths that it may be about."""


def changed_lines(a: str | None, b: str | None) -> tuple[int, int]:
    """How many lines were taken out and put in."""
    if a is None or b is None:
        return 0, 0
    found = list(difflib.unified_diff(a.splitlines(), b.splitlines(), lineterm="", n=0))[2:]
    return sum(line.startswith("-") for line in found), sum(line.startswith("+") for line in found)


def changed_comments(a: Document, b: Document, pairs: Mapping[str, Pairs]) -> tuple[list[str], list[CommentChange]]:
    """Comments that are gone, and those that say something else now: about the same thing, or in much the same words.

    Args:
        a: The file before.
        b: The file after.
        pairs: Entries of the files that belong together, by section.
    """
    if a.text is None or b.text is None:
        return [], []
    entries: dict[Path, Path] = {
        (role, i): (role, j) for role, found in pairs.items() for i, j in found if i is not None and j is not None
    }
    old = [
        (text, {(*entries.get(path[:2], path[:2]), *path[2:]) for path in about})
        for text, about in places_of_comments(a)
    ]
    new = [(text, set(about)) for text, about in places_of_comments(b)]
    gone, left = _unequal(old, new)
    twins: dict[int, int] = {}
    if len(gone) * len(left) <= _MANY:
        alike = {(i, j): difflib.SequenceMatcher(None, old[i][0], new[j][0], False).ratio() for i in gone for j in left}
        about_one = [(-score, *pair) for pair, score in alike.items() if old[pair[0]][1] & new[pair[1]][1]]
        in_one_way = [(-score, *pair) for pair, score in alike.items() if score > _EDITED]
        for _, i, j in [*sorted(about_one), *sorted(in_one_way)]:
            if i not in twins and j not in twins.values():
                twins[i] = j
    lost = [old[i][0] for i in gone if i not in twins]
    return lost, [CommentChange(before=old[i][0], after=new[j][0]) for i, j in sorted(twins.items())]


def _unequal(old: Sequence[Comment], new: Sequence[Comment]) -> tuple[list[int], list[int]]:
    """Places of the comments that have no equal one on the other side, if possible one about the same thing."""
    there = defaultdict[str, list[int]](list)
    for j, (text, _) in enumerate(new):
        there[text].append(j)
    gone = []
    for i, (text, about) in enumerate(old):
        twin = next((j for j in there[text][:_NEAR] if new[j][1] & about), None)
        if twin is not None:
            there[text].remove(twin)
        else:
            gone.append(i)
    rest = []
    for i in gone:
        if there[old[i][0]]:
            there[old[i][0]].pop(0)
        else:
            rest.append(i)
    return rest, sorted(j for found in there.values() for j in found)


def comments_told(there: bool, lost: Sequence[str], edited: Sequence[CommentChange]) -> str:
    """What became of the comments, in words; empty if there were none."""
    told = [
        f"{len(found)} comment{'s' * (len(found) != 1)} {what}"
        for what, found in (("lost", lost), ("changed", edited))
        if found
    ]
    if there and not lost:
        told.insert(0, "no comment lost")
    return ", ".join(told)
