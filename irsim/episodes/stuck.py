"""Why an object makes no progress: a collision, an obstruction, a missing heading, or a goal that it circles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irsim.common.angles import wrap
from irsim.common.text import quoted, seconds
from irsim.navigation.clearances import approaches
from irsim.scenario.resolve.braking import follow_text
from irsim.simulation.events import Event, is_collision_of, passable_names

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = [
    "REACTIVE",
    "Circle",
    "Obstruction",
    "find_circling",
    "find_jammed",
    "find_obstruction",
    "heading_message",
    "is_moving_obstacle",
    "jam_message",
    "no_progress_since",
    "no_way_message",
    "reactive_behavior",
    "stalled_since",
]

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
_MAX_OBSTRUCTION_DISTANCE = 0.5
"""Distance [m] up to which an object obstructs one that makes no progress."""
_PUSHED = 1e-3
"""Distance [m] below which bodies that push each other are in contact."""
_MAX_WALL_DISTANCE = 2.0
"""Distance [m] up to which something static obstructs a car that plans no path."""
REACTIVE = ("rvo", "orca", "avocado", "footprint_orca", "sfm")
"""Behaviors that avoid obstacles without planning a path."""
_MAX_JAM_DISTANCE = 2.0
"""Distance [m] up to which a jammed obstacle obstructs an object, as some behaviors keep this far from people."""
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
            f"radius {self.radius:.1f} m, never nearer than {self.nearest:.2f} m "
            "(raise goal_threshold, or let it turn more sharply)"
        )


@dataclass(frozen=True, slots=True)
class Obstruction:
    """An object close to one that makes no progress.

    Attributes:
        message: Its name and distance, and the time of the collision that stopped it, if one did.
        held: Whether a collision stopped it.
        pushed: Whether the two are in contact, in a world whose bodies push each other.
        advice: What the scenario should say instead, None if that is not known.
    """

    message: str
    held: bool
    pushed: bool = False
    advice: str | None = None


def is_moving_obstacle(record: ObjectRecord) -> bool:
    """Whether an object is an obstacle that moves by its own behavior or that of its group."""
    behaves = record.behavior is not None or record.group_behavior is not None
    return record.role == "obstacle" and not record.static and behaves


def find_jammed(simulation: Simulation, events: Sequence[Event]) -> dict[str, Event]:
    """Find moving obstacles that a collision with another obstacle has stopped short of their goal.

    Args:
        simulation: The simulation in its present state; its first world counts.
        events: Events of the episode so far.

    Returns:
        Name of each obstacle -> the collision that stopped it.
    """
    records = simulation.scenario.objects
    robots = {record.name for record in records if record.role == "robot"}
    held = {
        record.name
        for row, record in enumerate(records)
        if is_moving_obstacle(record) and simulation.stopped[row] and not simulation.arrived[row]
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


def jam_message(simulation: Simulation, held: dict[str, Event]) -> str | None:
    """How many moving obstacles a collision has stopped, and what prevents that; None if there are none."""
    if not held:
        return None
    count = sum(is_moving_obstacle(record) for record in simulation.scenario.objects)
    first = min(held.values(), key=lambda event: event.step)
    hit = f"{quoted(first.object)} hit {quoted(first.partner)} at {seconds(first.time)}"
    return (
        f"{len(held)} of {count} moving obstacle{'s' * (count != 1)} {'was' if len(held) == 1 else 'were'} stopped by "
        f"a collision ({'first ' * (len(held) > 2)}{hit}): collision_mode: unobstructed_obstacles lets them go on"
    )


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


def find_obstruction(
    simulation: Simulation, index: int, held: dict[str, Event], pose: NDArray[np.float64] | None = None
) -> Obstruction | None:
    """Find the object that most likely obstructs another; None if nothing is close.

    Args:
        simulation: The simulation; its first world counts.
        index: Index of the obstructed object.
        held: Moving obstacles stopped by a collision, from :func:`find_jammed`.
        pose: (N, 3) poses of all objects; default: the present ones.
    """
    poses = simulation.pose[: simulation.objects] if pose is None else pose
    [found] = approaches(poses[None], simulation, [index], 1)
    record = simulation.scenario.objects[index]
    still = {other.name for other in simulation.scenario.objects if other.static}
    car = getattr(record.kinematics, "steered", False) and reactive_behavior(record) is not None

    def most(partner: str) -> float:
        if partner in held:
            return _MAX_JAM_DISTANCE
        return _MAX_WALL_DISTANCE if car and partner in still else _MAX_OBSTRUCTION_DISTANCE

    close = [near for near in found if near.distance < most(near.partner)]
    if not close:
        return None
    near = next((near for near in close if near.partner in held), close[0])
    where = f"{quoted(near.partner)} is {near.distance:.2f} m from it"
    if near.partner in held:
        since = seconds(held[near.partner].time)
        return Obstruction(f"{where} and has been stopped since a collision at {since}", held=True)
    name = reactive_behavior(record)
    pushed = simulation.scenario.world.collision_mode == "contact" and near.distance < _PUSHED
    where = f"it pushes against {quoted(near.partner)}" if pushed else where
    if name is None or near.partner not in still:
        return Obstruction(where, held=False, pushed=pushed)
    lacks = ", and a car cannot turn on the spot" if car else ""
    return Obstruction(
        where,
        held=False,
        pushed=pushed,
        advice=f"{name} plans no path{lacks}: use {follow_text(record)}",
    )


def no_way_message(simulation: Simulation, events: Sequence[Event], name: str) -> str | None:
    """Why an object with the behavior ``follow`` finds no path to its present goal; None if it has found one.

    Args:
        simulation: The simulation; its first world counts.
        events: Events of the episode so far.
        name: Name of the object.
    """
    kinds = ("no_path", "waypoint", "arrival")
    event = next((event for event in reversed(events) if event.object == name and event.kind in kinds), None)
    if event is None or event.kind != "no_path":
        return None
    if event.partner is None:
        return _no_path_message(simulation, name)
    row = next(i for i, record in enumerate(simulation.scenario.objects) if record.name == event.partner)
    other = quoted(event.partner)
    if simulation.arrived[row]:
        yields = simulation.scenario.world.after_arrival == "yield"
        room = "" if yields else ", or let arrived robots make room: after_arrival: yield"
        return f"there is no way round {other}, which has arrived there (move the goal of {other} aside{room})"
    hit = next((e for e in events if e.kind == "collision" and event.partner in (e.object, e.partner)), None)
    since = "" if hit is None else f" since a collision at {seconds(hit.time)}"
    return f"there is no way round {other}, which has been stopped{since}"


def _no_path_message(simulation: Simulation, name: str) -> str:
    row = next(i for i, record in enumerate(simulation.scenario.objects) if record.name == name)
    record, goal = simulation.scenario.objects[row], simulation.state.goal[row]
    if not (getattr(record.kinematics, "steered", False) and record.heading_counts(goal.tolist())):
        return "there is no path to its goal"
    reverse = record.vel_min[0] < 0
    return "there is no path to its goal with that heading" + ("" if reverse else " without reverse (vel_min)")


def reactive_behavior(record: ObjectRecord) -> str | None:
    """The behavior of an object, or of its group, if it avoids obstacles without planning a path; else None."""
    options = record.active_behavior
    name = str(getattr(options, "name", ""))
    return name if name in REACTIVE else None


def heading_message(record: ObjectRecord, pose: NDArray[np.float64], goal: NDArray[np.float64]) -> str | None:
    """Message for an object that is at its goal with a wrong heading; None if that is not the case.

    Args:
        record: The object.
        pose: (3,) its pose [m, m, rad].
        goal: (3,) its goal; the heading is NaN where it does not matter.
    """
    if not record.heading_counts(goal.tolist()):
        return None
    if not math.dist(pose[:2], goal[:2]) <= record.goal_threshold:
        return None
    off = abs(math.remainder(float(pose[2] - goal[2]), 2 * math.pi))
    return f"it is at its goal, but its heading is off by {off:.2f} rad (arrive_mode: state requires the heading)"


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
