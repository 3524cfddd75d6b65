"""Who is who to a robot: other robots, humans, static things."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = [
    "HUMAN",
    "KINDS",
    "NOBODY",
    "ROBOT",
    "STATIC",
    "company_of",
    "on_their_way",
    "social_groups",
]

KINDS = ("robot", "human", "static")
"""Kinds of objects, in the order of the numbers below."""
ROBOT, HUMAN, STATIC, NOBODY = range(4)
_HUMAN_TAG = "pedestrian"


def company_of(records: Sequence[ObjectRecord]) -> NDArray[np.uint8]:
    """(N,) what each object is to a robot beside it.

    *human*: an obstacle that moves by itself, or an object tagged ``pedestrian``; *robot*: a robot; *static*: what
    stands still or is only pushed, maps, walls round the world; nobody: what is ``unobstructed``.
    """
    return np.array([_kind(record) for record in records], dtype=np.uint8)


def social_groups(records: Sequence[ObjectRecord]) -> list[tuple[int, ...]]:
    """Who walks together: the members of each of the ``social_groups`` of a group behavior, as indices of objects."""
    members: dict[int, list[int]] = {}
    for index, record in enumerate(records):
        members.setdefault(record.group, []).append(index)
    found = []
    for mine in members.values():
        together = getattr(records[mine[0]].group_behavior, "social_groups", None) or ()
        found += [tuple(mine[place] for place in group if place < len(mine)) for group in together]
    return found


def on_their_way(records: Sequence[ObjectRecord]) -> frozenset[str]:
    """Names of the humans that go to a last goal: not those that wander or walk round and round."""
    kinds = company_of(records)
    return frozenset(
        record.name
        for record, kind in zip(records, kinds, strict=True)
        if kind == HUMAN and not record.static and record.goals and not record.wander and not record.loop
    )


def _kind(record: ObjectRecord) -> int:
    if record.unobstructed:
        return NOBODY
    if _HUMAN_TAG in record.tags:
        return HUMAN
    if record.role == "robot":
        return ROBOT
    return STATIC if record.static or record.kinematics is None else HUMAN
