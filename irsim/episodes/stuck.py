"""Why something gets nowhere: a collision that holds it, what is in its way, a heading it lacks, a goal it circles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irsim.common.text import clean, seconds
from irsim.metrics.clearance import approaches
from irsim.metrics.trajectory import wrapped
from irsim.simulation.events import Event, is_collision_of, passable_names

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = [
    "Circle",
    "Obstruction",
    "circling",
    "gets_nowhere_since",
    "in_the_way",
    "jam_told",
    "jammed",
    "lacks_heading",
    "moves_by_itself",
]

_WINDOW = 5.0
"""A robot that has moved by less than ``_LITTLE`` for so long gets nowhere [s]."""
_LITTLE = 0.1
"""[m]; of a very slow one, half of what it could move."""
_CLOSE = 0.5
"""What is nearer than this is in the way of a robot that stands [m]."""
_KEPT = 2.0
"""Some behaviors keep so far from people who stand since a collision [m]."""
_LEAST_RADIUS = 0.05
"""Of a circle; with less it turns on the spot [m]."""
_TURNS = 1.5
"""So often it has gone round."""


@dataclass(frozen=True, slots=True)
class Circle:
    """A way round and round a goal.

    Attributes:
        radius: Of the way [m].
        nearest: Least distance to the goal [m].
        since: Row of the poses from which on.
    """

    radius: float
    nearest: float
    since: int

    @property
    def told(self) -> str:
        """How, and what to do, in words."""
        return (
            f"radius {self.radius:.1f} m, never nearer than {self.nearest:.2f} m "
            "(raise goal_threshold, or let it turn more sharply)"
        )


@dataclass(frozen=True, slots=True)
class Obstruction:
    """What stands close to something that gets nowhere.

    Attributes:
        told: Who, how near, and since when it stands if it does since a collision, in words.
        held: Whether it stands since a collision.
    """

    told: str
    held: bool


def moves_by_itself(record: ObjectRecord) -> bool:
    """Whether an object is an obstacle with a behavior of its own or of its group."""
    behaves = record.behavior is not None or record.group_behavior is not None
    return record.role == "obstacle" and not record.static and behaves


def jammed(simulation: Simulation, events: Sequence[Event]) -> dict[str, Event]:
    """Moving obstacles on their way that stand since they hit another obstacle, with that collision, by name.

    Args:
        simulation: As it is now; its first world.
        events: Of the episode so far.
    """
    records = simulation.scenario.objects
    robots = {record.name for record in records if record.role == "robot"}
    held = {
        record.name
        for row, record in enumerate(records)
        if moves_by_itself(record) and simulation.stopped[row] and not simulation.arrived[row]
    }
    if not held:
        return {}
    passable, first = passable_names(simulation), dict[str, Event]()
    for event in events:
        if event.kind == "collision":
            for name in (event.object, str(event.partner)):
                if name in held and name not in first and is_collision_of(event, name, passable):
                    first[name] = event
    return {name: event for name, event in first.items() if not robots & {event.object, event.partner}}


def jam_told(simulation: Simulation, held: dict[str, Event]) -> str | None:
    """Who stands since a collision, in words; None if nobody does."""
    if not held:
        return None
    count = sum(moves_by_itself(record) for record in simulation.scenario.objects)
    first = min(held.values(), key=lambda event: event.step)
    whom = f"'{clean(first.object, 40)}' hit '{clean(first.partner, 40)}' at {seconds(first.time)}"
    return (
        f"{len(held)} of {count} moving obstacle{'s' * (count != 1)} stand{'s' * (len(held) == 1)} since a collision "
        f"({'first ' * (len(held) > 2)}{whom}): with collision_mode: unobstructed_obstacles they go on"
    )


def gets_nowhere_since(places: NDArray[np.float64], step_time: float, max_speed: float) -> int | None:
    """Since which row an object has hardly moved at the end of its way; None if it has, or the way is too short.

    Args:
        places: (T, 2) where it was [m].
        step_time: From row to row [s].
        max_speed: Its own highest speed [m/s].
    """
    if not len(places):
        return None
    little = min(_LITTLE, _WINDOW / 2 * max_speed or _LITTLE)
    far = np.flatnonzero(np.hypot(*(places - places[-1]).T) >= little)
    since = int(far[-1]) + 1 if far.size else 0
    return None if len(places) - 1 - since < max(1, round(_WINDOW / step_time)) else since


def in_the_way(
    simulation: Simulation, index: int, held: dict[str, Event], pose: NDArray[np.float64] | None = None
) -> Obstruction | None:
    """What stands close to an object; None if nothing does.

    Args:
        simulation: Where it is.
        index: Which object.
        held: From :func:`jammed`.
        pose: (N, 3) of all objects; default: the present ones.
    """
    poses = simulation.pose[: simulation.objects] if pose is None else pose
    [found] = approaches(poses[None], simulation, [index], 1)
    close = [near for near in found if near.distance < (_KEPT if near.partner in held else _CLOSE)]
    if not close:
        return None
    near = next((near for near in close if near.partner in held), close[0])
    where = f"'{clean(near.partner, 40)}' is {near.distance:.2f} m from it"
    if near.partner in held:
        return Obstruction(f"{where} and stands since a collision at {seconds(held[near.partner].time)}", held=True)
    return Obstruction(where, held=False)


def lacks_heading(record: ObjectRecord, pose: NDArray[np.float64], goal: NDArray[np.float64]) -> str | None:
    """That an object stands at its goal, but not with its heading, in words; None if that is not so.

    Args:
        record: The object.
        pose: (3,) where it is [m, m, rad].
        goal: (3,) where it wants to be; the heading is NaN where it does not matter.
    """
    if record.arrive_mode != "state" or math.isnan(goal[2]):
        return None
    if not math.dist(pose[:2], goal[:2]) <= record.goal_threshold:
        return None
    off = abs(math.remainder(float(pose[2] - goal[2]), 2 * math.pi))
    return f"it is at its goal, but its heading is off by {off:.2f} rad (arrive_mode: state needs it too)"


def circling(poses: NDArray[np.float64], goal: NDArray[np.float64]) -> Circle | None:
    """The circle that an object drives round its goal at the end of its way; None if it does not.

    Args:
        poses: (T, 3) x, y [m] and heading [rad] since it has this goal.
        goal: (2,) that goal [m].
    """
    if len(poses) < 3:
        return None
    turned = np.abs(np.cumsum(wrapped(np.diff(poses[:, 2]))[::-1]))  # since then, backwards
    full, more = (np.flatnonzero(turned >= turns * 2 * math.pi) for turns in (1.0, _TURNS))
    if not more.size:
        return None
    start = len(poses) - 2 - int(full[0])
    lap = poses[start:, :2]
    length = float(np.hypot(*np.diff(lap, axis=0).T).sum())
    radius = length / (2 * math.pi)
    away = np.hypot(*(poses[:, :2] - goal).T)
    nearest, farthest = float(away[start:].min()), float(away[start:].max())
    closed = math.dist(lap[-1], lap[0]) < radius
    if radius < _LEAST_RADIUS or not closed or farthest > 2 * radius:
        return None
    outside = np.flatnonzero(away > 1.1 * farthest)
    return Circle(radius, nearest, int(outside[-1]) + 1 if outside.size else 0)
