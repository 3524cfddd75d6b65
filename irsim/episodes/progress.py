"""Whether an object makes progress: it stands still, creeps, drives to and fro, or circles its goal."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irsim.common.angles import wrap

if TYPE_CHECKING:
    from irsim.objects.view import ObjectView
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.events import Event
    from irsim.simulation.simulation import Simulation

__all__ = ["Circle", "find_circling", "has_one_end", "no_progress_since", "stalled_since", "stalled_step"]

_WINDOW = 5.0
"""Time [s] in which an object that makes progress moves by at least ``_MIN_MOVE``."""
_MIN_MOVE = 0.1
"""Least movement [m] in the window that counts as progress; very slow objects need half of what they could move."""
_STALL_SHARE = 0.1
"""Share of what its top speed allows by which an object that makes progress comes nearer to its goal in the window."""
_CREEP_SHARE = 0.25
"""Share of what its top speed allows below which an object without progress creeps."""
_TO_AND_FRO_SHARE = 0.5
"""Share of the way driven in the window below which the net movement means driving to and fro."""
_MIN_CIRCLE_RADIUS = 0.05
"""Smallest radius [m] that counts as a circle rather than a turn on the spot."""
_MIN_TURNS = 1.5
"""Number of full turns after which a path counts as circling."""


@dataclass(frozen=True, slots=True)
class Circle:
    """A circular path around a goal.

    Attributes:
        radius: Radius of the path [m].
        nearest: Least distance to the goal [m].
        since: First row of the poses that belongs to the circle.
    """

    radius: float
    nearest: float
    since: int

    @property
    def message(self) -> str:
        """Size of the circle, and what to change in the scenario."""
        return (
            f"radius {self.radius:.1f} m, on these circles never nearer than {self.nearest:.2f} m "
            "(raise goal_threshold, or let it turn more sharply)"
        )


def has_one_end(record: ObjectRecord) -> bool:
    """Whether an object has a fixed last goal."""
    return not (record.wander or record.loop)


def no_progress_since(places: NDArray[np.float64], step_time: float, max_speed: float) -> int | None:
    """First row after which an object hardly moves up to the end; None if it moves, or the trajectory is too short.

    Args:
        places: (T, 2) positions of the object [m].
        step_time: Time between two rows [s].
        max_speed: Top speed of the object [m/s].
    """
    if not len(places):
        return None
    min_move = min(_MIN_MOVE, _WINDOW / 2 * max_speed or _MIN_MOVE)
    far = np.flatnonzero(np.hypot(*(places - places[-1]).T) >= min_move)
    since = int(far[-1]) + 1 if far.size else 0
    return None if len(places) - 1 - since < max(1, round(_WINDOW / step_time)) else since


def stalled_since(
    places: NDArray[np.float64], goal: NDArray[np.float64], step_time: float, max_speed: float
) -> int | None:
    """First row from which an object creeps or drives to and fro, hardly nearer to its goal, up to the end; else None.

    An object on a detour is fast and gets somewhere, so it is not stalled.

    Args:
        places: (T, 2) positions of the object [m] since it had its present goal.
        goal: (2,) present goal [m].
        step_time: Time between two rows [s].
        max_speed: Top speed of the object [m/s].
    """
    window = max(1, round(_WINDOW / step_time))
    if len(places) <= window or not 0 < max_speed < math.inf:
        return None
    possible = max_speed * window * step_time
    nearest = np.minimum.accumulate(np.hypot(*(places - goal).T))
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(places, axis=0).T))])
    gained, driven = nearest[:-window] - nearest[window:], way[window:] - way[:-window]
    moved = np.hypot(*(places[window:] - places[:-window]).T)
    lost = (driven < _CREEP_SHARE * possible) | (moved < _TO_AND_FRO_SHARE * driven)
    stalled = lost & (gained < _STALL_SHARE * possible)
    if not stalled[-1]:
        return None
    ended = np.flatnonzero(~stalled)
    return int(ended[-1]) + 1 if ended.size else 0


def stalled_step(simulation: Simulation, view: ObjectView, events: Iterable[Event]) -> int | None:
    """The step from which a robot hardly came nearer to its goal, up to the end; None if it made progress.

    Args:
        simulation: The simulation after the last step.
        view: The robot.
        events: Events of the episode.
    """
    if view.goal is None or not has_one_end(view.record):
        return None
    track = simulation.state.trajectory(view.row)[:, :2]
    offset = int(simulation.count[0]) - len(track) + 1  # step of the first row
    turn = max((e.step for e in events if e.kind == "waypoint" and e.object == view.name), default=0)
    begin = max(0, turn - offset)
    since = stalled_since(track[begin:], view.goal[:2, 0], simulation.scenario.world.step_time, view.max_speed)
    return None if since is None else offset + begin + since


def find_circling(poses: NDArray[np.float64], goal: NDArray[np.float64]) -> Circle | None:
    """Find the circle around its goal on which an object ends its trajectory; None if there is no such circle.

    Args:
        poses: (T, 3) x, y [m] and heading [rad], from the first row with the present goal on.
        goal: (2,) present goal [m].
    """
    if len(poses) < 3:
        return None
    turned = np.abs(np.cumsum(wrap(np.diff(poses[:, 2]))[::-1]))  # from each row to the end, last row first
    full, more = (np.flatnonzero(turned >= turns * 2 * math.pi) for turns in (1.0, _MIN_TURNS))
    if not more.size:
        return None
    start = len(poses) - 2 - int(full[0])
    lap = poses[start:, :2]
    length = float(np.hypot(*np.diff(lap, axis=0).T).sum())
    radius = length / (2 * math.pi)
    away = np.hypot(*(poses[:, :2] - goal).T)
    nearest, farthest = float(away[start:].min()), float(away[start:].max())
    closed = math.dist(lap[-1], lap[0]) < radius
    if radius < _MIN_CIRCLE_RADIUS or not closed or farthest > 2 * radius:
        return None
    outside = np.flatnonzero(away > 1.1 * farthest)
    return Circle(radius, nearest, int(outside[-1]) + 1 if outside.size else 0)
