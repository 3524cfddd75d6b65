"""Robots whose last goals overlap, so that only one of them can arrive."""

from __future__ import annotations

import numpy as np

from irsim.scenario.checks import Context
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.scenes import StartState
from irsim.validation.feasibility.tally import Tally

__all__ = ["check"]

_MAX_ROBOTS = 1000
"""Scenes with more robots are not checked."""


def check(context: Context, scene: StartState, movers: list[Mover], tally: Tally) -> None:
    """Report robots whose last goals are so close that the first to arrive blocks the other."""
    last = [
        (mover, goals[-1])
        for mover in movers
        if (goals := scene.goals[mover.record.id])
        and mover.record.role == "robot"
        and not (mover.record.wander or mover.record.loop or mover.record.unobstructed)
    ]
    if len(last) < 2 or len(last) > _MAX_ROBOTS:
        return
    place = np.array([goal[:2] for _, goal in last])
    size = np.array([mover.radius - mover.record.goal_threshold for mover, _ in last])
    gap = np.hypot(*(place[:, None] - place[None]).transpose(2, 0, 1))
    near = np.triu(gap < size[:, None] + size[None] - 1e-9, 1)
    codes = {path: code for code, path in enumerate(dict.fromkeys(mover.path for mover, _ in last))}
    entry = np.array([codes[mover.path] for mover, _ in last])
    pairs = np.argwhere(near)
    _, firsts = np.unique(entry[pairs] @ [len(codes), 1], return_index=True)
    for a, b in pairs[np.sort(firsts)]:
        first, second = last[a][0], last[b][0]
        mine = near & (entry == entry[b])
        count = int((mine.any(axis=0) | mine.any(axis=1)).sum())
        x, y = place[b]
        tally.add(
            "goals-overlap",
            second.path,
            second.record,
            f"the last goals of {count} robots are closer together than the robots are wide, for example those of "
            f"'{first.record.name}' and '{second.record.name}' at ({x:g}, {y:g}): the robot that arrives first blocks "
            "the other",
            "goals as far apart as the robots are wide, one per object: goal: [[x, y], [x, y], ...]",
            serious=False,
        )
