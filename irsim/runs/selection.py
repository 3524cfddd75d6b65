"""Which objects of a run a table is about: one or several names, all that move, a role or a tag."""

from __future__ import annotations

from irsim.runs.reading import Run

__all__ = ["ALL", "chosen_objects"]

ALL = "all"
"""Stands for all objects that can move."""
_ROLES = {"robot": "robot", "robots": "robot", "obstacle": "obstacle", "obstacles": "obstacle"}


def chosen_objects(run: Run, asked: str | None) -> tuple[list[int], frozenset[str] | None]:
    """Return the indices of the chosen objects, and their names if only these are wanted in lists of events.

    Args:
        run: The run.
        asked: Name of an object, ``all`` (all that can move), ``robots``, ``obstacles`` (those that can move), a tag,
            or several of these, separated by commas; None for all robots, and all objects in lists of events. The name
            of an object goes before its other meanings.

    Raises:
        RunError: There is no such object.
    """
    objects = run.resolved["objects"]
    if asked is None:
        return [index for index, item in enumerate(objects) if item.get("role") == "robot"], None
    found: dict[int, None] = {}
    words = [asked] if asked in run.names else [word.strip() for word in asked.split(",") if word.strip()] or [asked]
    for word in words:
        found.update(dict.fromkeys(_named(run, word)))
    return sorted(found), None if words == [ALL] and ALL not in run.names else frozenset(run.names[k] for k in found)


def _named(run: Run, word: str) -> list[int]:
    """Return the indices of the objects that one word means."""
    objects = run.resolved["objects"]
    if word in run.names:
        return [run.index_of(word)]
    movable = [k for k, item in enumerate(objects) if item.get("kinematics") is not None and not item.get("static")]
    if word == ALL:
        return [k for k, item in enumerate(objects) if k in movable or item.get("role") == "robot"]
    if word in _ROLES:
        wanted = _ROLES[word]
        return [
            k for k, item in enumerate(objects) if item.get("role") == wanted and (k in movable or wanted == "robot")
        ]
    tagged = [k for k, item in enumerate(objects) if word in (item.get("tags") or [])]
    return tagged or [run.index_of(word)]
