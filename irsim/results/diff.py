"""The typed result of ``irsim.diff``: how two scenarios differ."""

from __future__ import annotations

from typing import Any, Literal

from irsim.results.base import Result

__all__ = ["CommentChange", "KeyChange", "ScenarioDiff", "WorldChange"]


class KeyChange(Result):
    """A key that differs between two files."""

    change: Literal["added", "removed", "changed", "moved"]
    """``moved``: an entry that stands before or after others now; ``before`` and ``after`` are its places."""
    path: str
    """Where it is now; where it was if it was removed."""
    before: Any = None
    after: Any = None


class WorldChange(Result):
    """A fact that differs between two worlds."""

    object: str | None
    """Name of the object (its new one); None for the world itself."""
    change: Literal["added", "removed", "changed"]
    key: str | None = None
    """Which fact of it: ``pose``, ``sensors[0].number``."""
    before: Any = None
    after: Any = None
    direct: bool = False
    """It is what a changed key says, no more; lists for people have only the key."""


class CommentChange(Result):
    """A comment that was edited."""

    before: str
    after: str


class ScenarioDiff(Result):
    """What ``irsim diff`` found."""

    before: str
    after: str
    same: bool
    """Neither a key nor a fact differs; comments and layout may."""
    summary: str
    keys: list[KeyChange]
    """Changes of the files; entries are recognised by name or likeness when others come or go before them."""
    world: list[WorldChange] | None
    """Changes of the worlds, both built with one seed; None if one of the scenarios is invalid."""
    comments_lost: list[str]
    """Comments that are gone; one that says something else now is not among them."""
    comments_changed: list[CommentChange]
    """Comments that were edited."""
    lines_removed: int
    lines_added: int
