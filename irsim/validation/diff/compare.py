"""Comparison of two scenarios: by key in the files, and by object in the worlds built from them."""

from __future__ import annotations

import difflib
from collections import defaultdict
from collections.abc import Mapping, Sequence

from irsim.common.text import listed, plural
from irsim.diagnostics.diagnostic import Path
from irsim.diagnostics.errors import PlacementError
from irsim.results.validation import CommentChange, KeyChange, ScenarioDiff, WorldChange
from irsim.scenario.read import Reading
from irsim.scenario.yaml.comments import comments, places_of_comments
from irsim.scenario.yaml.document import Document
from irsim.validation.diff.keys import Pairs, changed_keys, data_of, entry_pairs, place
from irsim.validation.diff.worlds import changed_worlds

__all__ = ["compare"]

_MAX_NAMED = 6
"""Number of keys or objects that the summary names."""


def compare(a: Reading, b: Reading, *, seed: int | None = None) -> ScenarioDiff:
    """Compare two scenarios that have been read.

    Args:
        a: The first scenario.
        b: The second scenario.
        seed: Seed with which both worlds are built; default: the scenario's own, else 0.
    """
    keys = list(changed_keys(data_of(a.document), data_of(b.document), ()))
    pairs = entry_pairs(a.document, b.document)
    worlds, why = None, "one of the scenarios is invalid"
    if a.scenario is not None and b.scenario is not None:
        try:
            worlds = changed_worlds(a.scenario, b.scenario, pairs, seed, keys)
        except PlacementError as error:
            why = error.diagnostics[0].message
    lines = changed_lines(a.document.text, b.document.text)
    lost, edited = changed_comments(a.document, b.document, pairs)
    there = bool(comments(a.document.text or ""))
    return ScenarioDiff(
        before=a.document.name or "(text)",
        after=b.document.name or "(text)",
        same=not keys and not worlds,
        summary=_summary(keys, worlds, why, comments_message(there, lost, edited)),
        keys=keys,
        world=worlds,
        comments_lost=lost,
        comments_changed=edited,
        lines_removed=lines[0],
        lines_added=lines[1],
    )


def _summary(keys: Sequence[KeyChange], world: Sequence[WorldChange] | None, why: str, comments: str) -> str:
    moved = [change for change in keys if change.change == "moved"]
    written = [change for change in keys if change.change != "moved"]
    if not written:
        text = "no key differs but for the order" if moved else "no key differs"
    else:
        named = listed([place(change.change, change.path) for change in written], _MAX_NAMED)
        text = f"{plural(len(written), 'key')} differ{'s' * (len(written) == 1)}: {named}"
    if moved:
        places = listed([f"{change.before} is now {change.after}" for change in moved], _MAX_NAMED)
        text += f"{'; the order differs' * bool(written)}: {places}"
        if any(change.path.startswith(("robot[", "obstacle[")) and change.path.count("[") == 1 for change in moved):
            text += ", which changes ids and labels"
        if any(change.path.startswith("robot[") and change.path.count("[") == 1 for change in moved):
            text += " and which robot env.step(action) drives"
    if world is None:
        text += f"; the worlds are not compared: {why}"
    else:
        further = list(dict.fromkeys(change.object or "the world" for change in world if not change.direct))
        named = listed(further, _MAX_NAMED)
        if further:
            text += f"; which also changes {named}" if keys else f"; in the world: {named}"
        elif not world:
            text += "; the worlds are the same"
    return text + (f"; {comments}" if comments else "")


_MIN_LIKENESS = 0.5
"""Similarity above which two comments count as one that was edited, wherever they stand."""
_MAX_CANDIDATES = 1_000
"""Number of pairs of comments that are compared."""
_MAX_EQUAL = 100
"""Number of equal comments among which the one about the same key is sought."""

Comment = tuple[str, set[Path]]
"""Text of a comment, and the paths of the keys that it may be about."""


def changed_lines(a: str | None, b: str | None) -> tuple[int, int]:
    """Number of lines that were removed and added."""
    if a is None or b is None:
        return 0, 0
    lines = list(difflib.unified_diff(a.splitlines(), b.splitlines(), lineterm="", n=0))[2:]
    return sum(line.startswith("-") for line in lines), sum(line.startswith("+") for line in lines)


def changed_comments(a: Document, b: Document, pairs: Mapping[str, Pairs]) -> tuple[list[str], list[CommentChange]]:
    """Find comments that were lost or edited.

    A comment counts as edited if the other file has one about the same key, or one in similar words.

    Args:
        a: The first file.
        b: The second file.
        pairs: Matching entries of the files, by section.

    Returns:
        Texts of the lost comments, and both texts of each edited one.
    """
    if a.text is None or b.text is None:
        return [], []
    entries: dict[Path, Path] = {
        (role, i): (role, j) for role, matched in pairs.items() for i, j in matched if i is not None and j is not None
    }
    old = [
        (text, {(*entries.get(path[:2], path[:2]), *path[2:]) for path in about})
        for text, about in places_of_comments(a)
    ]
    new = [(text, set(about)) for text, about in places_of_comments(b)]
    gone, left = _without_equal(old, new)
    twins: dict[int, int] = {}
    if len(gone) * len(left) <= _MAX_CANDIDATES:
        alike = {(i, j): difflib.SequenceMatcher(None, old[i][0], new[j][0], False).ratio() for i in gone for j in left}
        about_one = [(-score, *pair) for pair, score in alike.items() if old[pair[0]][1] & new[pair[1]][1]]
        in_one_way = [(-score, *pair) for pair, score in alike.items() if score > _MIN_LIKENESS]
        for _, i, j in [*sorted(about_one), *sorted(in_one_way)]:
            if i not in twins and j not in twins.values():
                twins[i] = j
    lost = [old[i][0] for i in gone if i not in twins]
    return lost, [CommentChange(before=old[i][0], after=new[j][0]) for i, j in sorted(twins.items())]


def _without_equal(old: Sequence[Comment], new: Sequence[Comment]) -> tuple[list[int], list[int]]:
    """Indices of the comments without an equal one in the other file; equal comments about the same key pair first."""
    there = defaultdict[str, list[int]](list)
    for j, (text, _) in enumerate(new):
        there[text].append(j)
    gone = []
    for i, (text, about) in enumerate(old):
        twin = next((j for j in there[text][:_MAX_EQUAL] if new[j][1] & about), None)
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
    return rest, sorted(j for indices in there.values() for j in indices)


def comments_message(there: bool, lost: Sequence[str], edited: Sequence[CommentChange]) -> str:
    """How many comments were lost and edited, in words.

    Args:
        there: Whether the first file has comments; without any the message is empty.
        lost: Texts of the lost comments.
        edited: The edited comments.
    """
    parts = [
        f"{plural(len(texts), 'comment')} {what}" for what, texts in (("lost", lost), ("changed", edited)) if texts
    ]
    if there and not lost:
        parts.insert(0, "no comment lost")
    return ", ".join(parts)
