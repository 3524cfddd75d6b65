"""The information of a behavior or policy besides the state, the limits and the goal of its own robot."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Literal, get_args

__all__ = ["FACTS", "Fact", "knowledge_class", "knowledge_text"]

Fact = Literal["circles", "outlines", "headings", "arrivals", "laws", "static", "map", "scan"]
"""A kind of facts about the world.

- ``circles``: place, velocity and bounding circle of other moving objects
- ``outlines``: their true outlines
- ``headings``: where they head, apart from their velocity
- ``arrivals``: which of them have arrived, or will not move
- ``laws``: which of them avoid collisions by a law of the same kind
- ``static``: outlines of what stands, without occlusion
- ``map``: everything static at once, to plan ways through it
- ``scan``: ranges of a lidar
"""
FACTS: tuple[Fact, ...] = get_args(Fact)
_WORDS: dict[Fact, str] = {
    "circles": "circles of other objects", "outlines": "outlines of other objects", "headings": "headings",
    "arrivals": "who has arrived",
    "laws": "who gives way by the same law", "static": "walls", "map": "the whole map", "scan": "a lidar",
}  # fmt: skip


def knowledge_class(known: Collection[Fact], neighbors: int = 0, reach: float = math.inf) -> str:
    """The class of a policy by its information, within which comparisons are fair.

    ``outlines``, ``circles``, ``neighbors(k, r)`` for the circles of the k nearest others within r (``+outlines`` where
    it sees these), ``lidar`` and ``map``, joined by ``+``, or ``blind``; with ``+intent`` for who also knows which
    others have arrived, or which law they follow.

    Args:
        known: The facts that it knows.
        neighbors: Number of objects that it sees; 0 for no limit.
        reach: Distance within which it sees them [m].
    """
    parts = [name for fact, name in (("scan", "lidar"), ("map", "map")) if fact in known]
    if neighbors and "circles" in known:
        parts.append(f"neighbors({neighbors})" if math.isinf(reach) else f"neighbors({neighbors}, {reach:g} m)")
        parts += ["outlines"] if "outlines" in known else []
    elif {"circles", "outlines"} & set(known):
        parts.append("outlines" if "outlines" in known else "circles")
    parts = parts or ["blind"]
    return "+".join([*parts, *(["intent"] if {"arrivals", "laws"} & set(known) else [])])


def knowledge_text(known: Collection[Fact]) -> str:
    """The facts in words, in a fixed order."""
    return ", ".join(_WORDS[fact] for fact in FACTS if fact in known) or "nothing but itself"
