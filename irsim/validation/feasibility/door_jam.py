"""Narrow passages that several robots share, whose local behavior jams there."""

from __future__ import annotations

import math
from typing import Any

from irsim.common.text import metres, plural
from irsim.scenario.checks import Context
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.reachability import Leg
from irsim.validation.feasibility.scenes import StartState
from irsim.validation.feasibility.tally import Tally
from irsim.validation.scene_passages import Places, passages_of_legs

__all__ = ["check"]

JAMMING = ("rvo", "sfm")
"""Local behaviors that do not give way by the rest of the planned path."""
_MAX_ROBOTS = 12
"""Number of robots whose passages are measured."""
_MAX_SCENES = 1
"""Number of scenes that are examined."""
_SAME_M = 0.3
"""Passages whose middles are closer are the same one [m]."""


def check(context: Context, scene: StartState, movers: list[Mover], legs: dict[int, list[Leg]], tally: Tally) -> None:
    """Report a passage in which no two of the robots that drive through it have room side by side."""
    robots = [mover for mover in movers if _may_jam(mover) and legs.get(mover.record.id)]
    if len(robots) < 2 or scene.seed >= _MAX_SCENES:
        return
    places = Places(scene.seed, scene.pose, scene.goals, scene.owner.things)
    shared: list[tuple[tuple[float, float], float, list[Mover]]] = []
    for mover in robots[:_MAX_ROBOTS]:
        by_leg = passages_of_legs(context.resolved, places, mover.record.id)
        for width, place in [one for passages in by_leg.values() for one in passages]:
            known = next((users for at, _, users in shared if math.dist(at, place) < _SAME_M), None)
            if known is None:
                shared.append((place, width, [mover]))
            elif mover not in known:
                known.append(mover)
    for place, width, users in sorted(shared, key=lambda one: one[1]):
        if len(users) > 1 and width < sum(sorted(2 * mover.radius for mover in users)[:2]):
            _report(users, width, place, tally)
            return


def _local(mover: Mover) -> str:
    options: Any = mover.record.active_behavior
    local = getattr(options, "local", "")
    return str(getattr(local, "name", local))


def _may_jam(mover: Mover) -> bool:
    follows = mover.behavior == "follow" and _local(mover) in JAMMING
    return follows and mover.record.role == "robot" and not mover.record.wander


def _report(users: list[Mover], width: float, place: tuple[float, float], tally: Tally) -> None:
    first = users[0]
    others = plural(len(users) - 1, "other robot")
    x, y = place
    tally.add(
        "door-jam",
        (*first.record.path, "behavior"),
        first.record,
        f"'{first.record.name}' and {others} drive through a gap of {metres(width)} at ({x:.2f}, {y:.2f}), in which no "
        f"two of them have room side by side: under 'follow' with the local behavior '{_local(first)}' they can "
        "jam there",
        "local: {name: orca} in their behaviors, with which they let each other pass",
    )
