"""Why an object makes no progress: a collision, an obstruction, a missing heading, or no reverse."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.text import plural, seconds
from irsim.episodes.scene_summary import called
from irsim.navigation.clearances import approaches
from irsim.scenario.resolve.braking import follow_text
from irsim.scenario.yaml.formatting import flow
from irsim.simulation.events import Event, is_collision_of, passable_names

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = [
    "REACTIVE",
    "Obstruction",
    "find_jammed",
    "find_obstruction",
    "heading_message",
    "is_moving_obstacle",
    "jam_message",
    "lacks_reverse",
    "needs_reverse",
    "no_way_message",
    "reactive_behavior",
    "reverse_fix",
    "reverse_message",
    "turning_radius",
]

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
_MAX_STEERING = 1.4
"""Steering angle [rad] that ``follow`` does not exceed."""


@dataclass(frozen=True, slots=True)
class Obstruction:
    """An object close to one that makes no progress.

    Attributes:
        message: Its name and distance, and the time of the collision that stopped it, if one did.
        held: Whether a collision stopped it.
        pushed: Whether the two are in contact, in a world whose bodies push each other.
        advice: The change of the scenario that helps, None if it is not known.
    """

    message: str
    held: bool
    pushed: bool = False
    advice: str | None = None


def is_moving_obstacle(record: ObjectRecord) -> bool:
    """Whether an object is an obstacle that moves by its own behavior or the behavior of its group."""
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
    """How many moving obstacles a collision has stopped, and how to prevent that; None without such obstacles."""
    if not held:
        return None
    count = sum(is_moving_obstacle(record) for record in simulation.scenario.objects)
    first = min(held.values(), key=lambda event: event.step)
    one, other = called(simulation.scenario, first.object), called(simulation.scenario, first.partner)
    hit = f"{one} hit {other} at {seconds(first.time)}"
    return (
        f"{len(held)} of {plural(count, 'moving obstacle')} {'was' if len(held) == 1 else 'were'} stopped by "
        f"a collision ({'first ' * (len(held) > 2)}{hit}): collision_mode: unobstructed_obstacles lets them go on"
    )


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
    [near_by] = approaches(poses[None], simulation, [index], 1)
    record = simulation.scenario.objects[index]
    still = {other.name for other in simulation.scenario.objects if other.static}
    car = getattr(record.kinematics, "steered", False) and reactive_behavior(record) is not None

    def most(partner: str) -> float:
        if partner in held:
            return _MAX_JAM_DISTANCE
        return _MAX_WALL_DISTANCE if car and partner in still else _MAX_OBSTRUCTION_DISTANCE

    close = [near for near in near_by if near.distance < most(near.partner)]
    if not close:
        return None
    near = next((near for near in close if near.partner in held), close[0])
    other = called(simulation.scenario, near.partner)
    where = f"{other} is {near.distance:.2f} m from it"
    if near.partner in held:
        since = seconds(held[near.partner].time)
        return Obstruction(f"{where} and has been stopped since a collision at {since}", held=True)
    name = reactive_behavior(record)
    pushed = simulation.scenario.world.collision_mode == "contact" and near.distance < _PUSHED
    where = f"it pushes against {other}" if pushed else where
    if name is None or near.partner not in still:
        return Obstruction(where, held=False, pushed=pushed)
    lacks = ", and a car cannot turn on the spot" if car else ""
    return Obstruction(
        where, held=False, pushed=pushed, advice=f"{name} plans no path{lacks}: use {follow_text(record)}"
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
    other = simulation.scenario.objects[row].called
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
    if not getattr(record.kinematics, "steered", False):
        return "there is no path to its goal"
    reverse = record.vel_min[0] < 0
    if record.heading_counts(goal.tolist()):
        return "there is no path to its goal with that heading" + ("" if reverse else " without reverse (vel_min)")
    backing = "" if reverse else ", and backs up with vel_min below 0"
    return (
        "there is no path to its goal (in tight places a car finds one with arrive_mode: state and the heading in its "
        f"goal{backing})"
    )


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


def lacks_reverse(record: ObjectRecord) -> bool:
    """Whether an object is a car under ``follow`` that cannot drive backward."""
    drive: Any = record.kinematics
    on_route = getattr(record.active_behavior, "name", "") == "follow"
    steered = bool(getattr(drive, "steered", False)) and bool(record.wheelbase)
    return on_route and steered and bool(record.vel_min) and record.vel_min[0] >= 0 and not record.static


def turning_radius(record: ObjectRecord) -> float:
    """Radius of the smallest circle that a car under ``follow`` drives [m]."""
    drive: Any = record.kinematics
    steering = min(_MAX_STEERING, math.inf if drive.psi_max is None else drive.psi_max)
    if drive.mode == "steer":
        steering = min(steering, record.vel_max[1])
    return (record.wheelbase or 0.0) / math.tan(steering) if steering > 0 else math.inf


def needs_reverse(record: ObjectRecord, pose: Sequence[float], goal: Sequence[float]) -> bool:
    """Whether a car that :func:`lacks_reverse` stands still because its goal lies inside its turning circle.

    ``follow`` then lets a car back up first; without reverse it waits there for ever.

    Args:
        record: The car.
        pose: x, y [m] and heading [rad].
        goal: x, y [m].
    """
    radius = turning_radius(record)
    dx, dy = goal[0] - pose[0], goal[1] - pose[1]
    if math.hypot(dx, dy) < record.goal_threshold or not math.isfinite(radius):
        return False
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    ahead, aside = cos * dx + sin * dy, abs(cos * dy - sin * dx)
    return math.hypot(ahead, aside - radius) < radius - 0.5 * record.goal_threshold


def reverse_fix(record: ObjectRecord) -> str:
    """The limits with which a car can back up."""
    return f"vel_min: {flow([-record.vel_max[0], *record.vel_min[1:]])}"


def reverse_message(record: ObjectRecord, pose: Sequence[float], goal: Sequence[float]) -> str | None:
    """Message for a car that stands still because it would have to back up; None if that is not the case."""
    if not lacks_reverse(record) or not needs_reverse(record, pose, goal):
        return None
    return (
        f"it needs reverse: the goal lies inside its turning circle of radius {turning_radius(record):.2f} m "
        f"({reverse_fix(record)} lets it back up)"
    )
