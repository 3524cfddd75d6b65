"""The typed result of ``irsim.diff``: how two scenarios differ."""

from __future__ import annotations

from typing import Any, Literal

from irsim.results.base import Result

__all__ = ["CommentChange", "KeyChange", "ScenarioDiff", "WorldChange"]


class KeyChange(Result):
    """A key that differs between two files."""

    change: Literal["added", "removed", "changed", "moved"]
    """``moved``: an entry whose place in its list changed; ``before`` and ``after`` are the two places."""
    path: str
    """Its path in the new file; in the old file if it was removed."""
    before: Any = None
    after: Any = None


class WorldChange(Result):
    """A fact that differs between two worlds."""

    object: str | None
    """Name of the object in the new world; None for the world itself."""
    change: Literal["added", "removed", "changed"]
    key: str | None = None
    """Which of its facts: ``pose``, ``sensors[0].number``."""
    before: Any = None
    after: Any = None
    direct: bool = False
    """Whether it only repeats a changed key; texts for people then show only the key."""


class CommentChange(Result):
    """A comment that was edited."""

    before: str
    after: str


class ScenarioDiff(Result):
    """What ``irsim diff`` found."""

    before: str
    after: str
    same: bool
    """True if neither a key nor a fact differs; comments and layout may differ."""
    summary: str
    keys: list[KeyChange]
    """Changes of the files; entries are matched by name or similarity when others are added or removed before them."""
    world: list[WorldChange] | None
    """Changes of the worlds, which are built with the same seed; None if one of the scenarios is invalid."""
    comments_lost: list[str]
    """Comments that were removed; edited ones are in ``comments_changed``."""
    comments_changed: list[CommentChange]
    """Comments that were edited."""
    lines_removed: int
    lines_added: int
