"""Incidents of an episode besides the outcomes of robots.

People touched each other, goals were jumped over, objects came late or left the world, and cars drove to and fro.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from irsim.common.arrays import Floats
from irsim.common.text import listed, metres, plural, quoted, seconds
from irsim.episodes.progress import has_one_end
from irsim.results.episode import Left
from irsim.simulation.build import steps_until
from irsim.simulation.events import Event

if TYPE_CHECKING:
    from irsim.results.episode import RobotResult
    from irsim.scenario.resolve.resolved import ResolvedScenario
    from irsim.simulation.simulation import Simulation

__all__ = [
    "MAX_LISTED_EXITS",
    "Incidents",
    "absence",
    "appearances_message",
    "closeness_message",
    "contacts_message",
    "exits_message",
    "find_exits",
    "find_incidents",
    "is_absent",
    "jumps_message",
    "nearest_to_goals",
    "returns_message",
    "shunting_message",
]

MAX_LISTED_EXITS = 10
"""Number of exits that a result lists one by one."""
_MAX_NAMED = 3
"""Number of objects that a sentence names."""
_NEAR = 1.0
"""A car that came within this distance of its goal should soon be there [m]."""
_MIN_TIME = 5.0
"""Time from then on that is worth a word [s]."""
_CLOSE = 5e-3
"""Distances below this are shown as 0.00 [m]."""


class Incidents(NamedTuple):
    """Incidents of an episode besides outcomes.

    Attributes:
        human_contacts: Events of the contacts that began between two humans.
        jumps: Name of each object that jumped over a goal and has not reached one since -> its last event
            ``overshoot``, in order of time.
        returns: Name of each object that jumped over its last goal, came back and arrived -> these two events.
    """

    human_contacts: list[Event]
    jumps: dict[str, Event]
    returns: dict[str, tuple[Event, Event]]


def find_incidents(humans: Collection[str], events: Sequence[Event]) -> Incidents:
    """Find the incidents of an episode.

    Args:
        humans: Names of the humans in the scenario.
        events: Events of the episode.
    """
    incidents = Incidents([], {}, {})
    for event in events:
        if event.kind == "collision":
            if event.object in humans and event.partner in humans:
                incidents.human_contacts.append(event)
        elif event.kind in ("arrival", "waypoint", "overshoot"):
            jump = incidents.jumps.pop(event.object, None)
            if jump is not None and event.kind == "arrival":
                incidents.returns[event.object] = (jump, event)
            if event.kind == "overshoot":
                incidents.jumps[event.object] = event
    return incidents


def contacts_message(contacts: Sequence[Event], who: str, *, brief: bool) -> str:
    """How often humans touched each other, and which two did first.

    Args:
        contacts: From :func:`find_human_contacts`; at least one.
        who: Their name in texts (:func:`irsim.simulation.roles.name_of_humans`).
        brief: Leave out the first one, which another message has.
    """
    first = contacts[0]
    hit = f"{'first ' * (len(contacts) > 1)}{quoted(first.object)} hit {quoted(first.partner)} at {seconds(first.time)}"
    return f"{plural(len(contacts), 'contact')} between {who}" + ("" if brief else f" ({hit})")


def jumps_message(jumps: dict[str, Event], nearest: Mapping[str, float]) -> str | None:
    """Which object jumped over its goal first, and what would let it arrive; None if none did.

    Args:
        jumps: From :func:`find_incidents`.
        nearest: Least distance [m] of each of these objects to its goal at any step from then on, as far as known.
    """
    if not jumps:
        return None
    first, others = next(iter(jumps.values())), len(jumps) - 1
    more = f" and {others} more after it" if others else ""
    near = nearest.get(first.object)
    close = "" if near is None else f", at no step from then on nearer than {metres(near)}"
    return (
        f"{quoted(first.object)} jumped over its goal at {seconds(first.time)}{close}{more} "
        f"(raise goal_threshold{' above that' if close else ''} or lower step_time)"
    )


def returns_message(returns: Mapping[str, tuple[Event, Event]], robots: Collection[str]) -> str | None:
    """Which robot passed its goal between two steps, came back and arrived; None if none did.

    Args:
        returns: From :func:`find_incidents`.
        robots: Names of the robots.
    """
    mine = [(name, *events) for name, events in returns.items() if name in robots]
    if not mine:
        return None
    name, jump, arrival = mine[0]
    more = f" and {len(mine) - 1} more robots did so" if len(mine) > 2 else " and 1 more did so" * (len(mine) - 1)
    return (
        f"{quoted(name)} passed its goal between two steps at {seconds(jump.time)}, came back and arrived at "
        f"{seconds(arrival.time)}{more} (goal_threshold is small for its speed and step_time, or for its noise)"
    )


def nearest_to_goals(simulation: Simulation, jumps: Mapping[str, Event]) -> dict[str, float]:
    """Least distance [m] of objects to the goal that they jumped over, at any step from then on.

    Args:
        simulation: The simulation after the last step.
        jumps: Name of each object -> its last event ``overshoot``.
    """
    nearest, count = dict[str, float](), int(simulation.count[0])
    for row, record in enumerate(simulation.scenario.objects):
        if record.name not in jumps:
            continue
        track = simulation.state.trajectory(row)[:, :2]
        start = max(0, jumps[record.name].step - 2 - (count - len(track)))
        goal = simulation.state.goal[row][:2]
        if len(track) > start and not np.isnan(goal).any():
            nearest[record.name] = float(np.hypot(*(track[start:] - goal).T).min())
    return nearest


def find_exits(scenario: ResolvedScenario, track: Callable[[int], Floats], steps: int) -> list[Left]:
    """Find moving objects that start in the world and leave it, in order of time.

    Args:
        scenario: The scenario that was simulated.
        track: Row of an object -> its (K, >= 2) positions [m], world frame, one per step up to the end of the run.
        steps: Number of steps executed by the end of the run.
    """
    exits = []
    x, y, right, top = scenario.world.bounds
    for row, record in enumerate(scenario.objects):
        if record.static:
            continue
        place = track(row)[:, :2]
        outside = np.flatnonzero(np.any((place < (x, y)) | (place > (right, top)), axis=1))
        if not outside.size or outside[0] == 0:
            continue
        first = int(outside[0])
        px, py = (float(value) for value in place[first])
        time = (steps + 1 - len(place) + first) * scenario.world.step_time
        exits.append(Left(name=record.name, time=time, x=px, y=py))
    return sorted(exits, key=lambda item: item.time)


def exits_message(scenario: ResolvedScenario, left: Sequence[Left]) -> str | None:
    """Which object left the world first, and what would keep it in; None if none did."""
    if not left:
        return None
    first, others = left[0], len(left) - 1
    more = f" and {others} more after it" if others else ""
    open_edge = scenario.world.boundary == "none"
    advice = f" ('world.boundary: walls' would keep {'them' if others else 'it'} in)" if open_edge else ""
    return f"{quoted(first.name)} left the world at {seconds(first.time)}{more}{advice}"


def is_absent(simulation: Simulation, row: int) -> bool:
    """Return whether an object is not in the world yet, or not any more."""
    return bool(simulation.appeared[row] < 0)


def absence(simulation: Simulation, row: int) -> str:
    """Say why an absent object is not in the world: its time has not come or is over, or its place is taken."""
    record = simulation.scenario.objects[row]
    if int(simulation.appeared[row]) < -1:
        return f"its recording ended at {seconds(record.vanish_time or 0.0)}"
    due = record.appear_time
    if int(simulation.count[0]) < steps_until(due, simulation.scenario.world.step_time):
        return f"it appears at {seconds(due)}"
    return f"since {seconds(due)} there has been no room for it at its start"


def appearances_message(simulation: Simulation) -> str | None:
    """Say which objects came later than their ``appear_time`` or not at all; None if all came in time."""
    late, missing, step_time = [], [], simulation.scenario.world.step_time
    for row, record in enumerate(simulation.scenario.objects):
        due, appeared = record.appear_time, int(simulation.appeared[row])
        if not due or record.recorded:
            continue  # a recording waits for no room
        if appeared < 0:
            missing.append(f"{quoted(record.name)} did not appear ({absence(simulation, row)})")
        elif appeared > steps_until(due, step_time):
            waited = seconds(appeared * step_time - due)
            late.append(f"{quoted(record.name)} appeared {waited} late, when there was room at its start")
    sentences = [listed(names, _MAX_NAMED) for names in (late, missing) if names]
    return "; ".join(sentences) or None


def shunting_message(simulation: Simulation, robots: Sequence[RobotResult], parked: Sequence[str]) -> str | None:
    """Which car was long near its last goal before it arrived, and how far it drove in all; None if none was."""
    shunting: list[str] = []
    state, step_time = simulation.state, simulation.scenario.world.step_time
    rows = {record.name: row for row, record in enumerate(simulation.scenario.objects)}
    for robot in robots:
        row = rows[robot.name]
        record, goals = simulation.scenario.objects[row], state.goals(row)
        if not goals or robot.name in parked or not has_one_end(record):
            continue
        if not getattr(record.kinematics, "steered", False):
            continue
        arrived = robot.time_to_goal
        steps = int(simulation.count[0]) if arrived is None else round(arrived / step_time)
        track = np.vstack([state.initial_state(row)[None, :2], state.trajectory(row)[:, :2]])[: steps + 1]
        away = np.hypot(*(track - goals[0][:2]).T)
        since, targets, _ = state.standings(row)
        renewed = np.flatnonzero((targets[1:, :2] != targets[:-1, :2]).any(axis=1))
        last_leg = int(since[renewed[-1] + 1]) if renewed.size else 0  # a tour may pass its last goal before
        near = np.flatnonzero(away[last_leg:] < _NEAR)
        if not near.size:
            continue
        first = last_leg + int(near[0])
        lengths = np.hypot(*np.diff(track, axis=0).T)
        driven, moved = float(lengths.sum()), float(lengths[first:].sum())
        time = (len(track) - 1 - first) * step_time
        if moved < 3 * _NEAR or time < _MIN_TIME:
            continue
        least = "" if arrived is not None else f", in the whole run no nearer than {metres(float(away.min()))}"
        shunting.append(
            f"{quoted(robot.name)} drove {metres(driven)} of a {metres(driven - moved + float(away[first]))} way, "
            f"{seconds(time)} of it to and fro at the goal{least}"
        )
    if not shunting:
        return None
    more = f" and {len(shunting) - 1} more likewise" if len(shunting) > 1 else ""
    return f"{shunting[0]}{more} (raise goal_threshold)"


def closeness_message(robots: Sequence[RobotResult]) -> str | None:
    """Which robot came within 0 m of something but did not touch it; None if none did."""
    names = [
        (robot.name, robot.nearest_called)
        for robot in robots
        if robot.min_clearance is not None
        and 0 <= robot.min_clearance < _CLOSE
        and robot.collision_count == robot.contacts_between_steps == 0
    ]
    if not names:
        return None
    (name, other), more = names[0], len(names) - 1
    others = f" and {plural(more, 'more robot')}" if more else ""
    beside = f" {other}" if other else " something"
    return f"{quoted(name)}{others} came within 5 mm of{beside} without touching: that is not a collision"
