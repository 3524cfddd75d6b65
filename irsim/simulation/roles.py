"""Kinds of objects from the view of a robot: other robots, humans, static objects."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irsim.scenario.resolve.resolved import PERSON_TAG

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = [
    "HUMAN",
    "IGNORED",
    "KINDS",
    "ROBOT",
    "STATIC",
    "humans_of",
    "kinds_of",
    "name_of_humans",
    "social_groups",
    "travelling_humans",
]

KINDS = ("robot", "human", "static")
"""Kinds of objects, in the order of the numbers below."""
ROBOT, HUMAN, STATIC, IGNORED = range(4)
_PERSON_WORDS = frozenset(
    {
        *("pedestrian", "person", "people", "human", "walker", "visitor", "child", "children", "kid", "adult", "man"),
        *("woman", "guest", "customer", "passenger", "commuter", "worker", "nurse", "patient", "student", "jogger"),
        *("runner", "crowd", "fußgänger", "passant", "peaton", "peatón", "persona", "行人"),
    }
)
"""Words for people in names and tags, without the s of plurals."""


def kinds_of(records: Sequence[ObjectRecord]) -> NDArray[np.uint8]:
    """(N,) kind of each object.

    *human*: an obstacle that moves by its behavior, or an object tagged ``pedestrian``; *robot*: a robot; *static*:
    an object that stands still or is only pushed, a map, a wall around the world; *ignored*: ``unobstructed`` objects.
    """
    return np.array([_kind(record) for record in records], dtype=np.uint8)


def social_groups(records: Sequence[ObjectRecord]) -> list[tuple[int, ...]]:
    """Members of each of the ``social_groups`` of group behaviors, as indices of objects."""
    members: dict[int, list[int]] = {}
    for index, record in enumerate(records):
        members.setdefault(record.group, []).append(index)
    groups = []
    for mine in members.values():
        together = getattr(records[mine[0]].group_behavior, "social_groups", None) or ()
        groups += [tuple(mine[place] for place in group if place < len(mine)) for group in together]
    return groups


def humans_of(records: Sequence[ObjectRecord]) -> list[ObjectRecord]:
    """Records of the humans (:func:`kinds_of`)."""
    return [record for record, kind in zip(records, kinds_of(records), strict=True) if kind == HUMAN]


def name_of_humans(records: Iterable[ObjectRecord]) -> str:
    """The name of humans in texts: ``people`` if each is tagged or named so, else ``moving obstacles``."""
    return "people" if all(_is_named_person(record) for record in records) else "moving obstacles"


def _is_named_person(record: ObjectRecord) -> bool:
    words = [word for text in (record.name, *record.tags) for word in re.split(r"[\W\d_]+", text.lower())]
    return any(word.removesuffix("s") in _PERSON_WORDS for word in words)


def travelling_humans(records: Sequence[ObjectRecord]) -> frozenset[str]:
    """Names of the humans that have a last goal, unlike objects that wander or loop."""
    moving = (record for record in humans_of(records) if not record.static)
    return frozenset(record.name for record in moving if record.goals and not record.wander and not record.loop)


def _kind(record: ObjectRecord) -> int:
    if record.unobstructed:
        return IGNORED
    if PERSON_TAG in record.tags:
        return HUMAN
    if record.role == "robot":
        return ROBOT
    return STATIC if record.static or record.kinematics is None else HUMAN
