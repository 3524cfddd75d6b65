"""What differs between two texts: lines and comments."""

from __future__ import annotations

import difflib
from collections.abc import Sequence

from irsim.results import CommentChange
from irsim.scenario.comments import comments

__all__ = ["changed_comments", "changed_lines", "comments_told"]

_EDITED = 0.5
"""Comments that are more alike than that are one that was edited."""


def changed_lines(a: str | None, b: str | None) -> tuple[int, int]:
    """How many lines were taken out and put in."""
    if a is None or b is None:
        return 0, 0
    found = list(difflib.unified_diff(a.splitlines(), b.splitlines(), lineterm="", n=0))[2:]
    return sum(line.startswith("-") for line in found), sum(line.startswith("+") for line in found)


def changed_comments(a: str | None, b: str | None) -> tuple[list[str], list[CommentChange]]:
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
