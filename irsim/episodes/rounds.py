"""Robots that patrol or wander: their laps, when a run ends, and how far they swing out behind waypoints."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from irsim.common.text import listed, metres, plural, quoted, seconds
from irsim.episodes.progress import has_one_end

if TYPE_CHECKING:
    from irsim.common.arrays import Floats
    from irsim.episodes.facts import EpisodeFacts
    from irsim.results.episode import RobotResult
    from irsim.results.run import Until
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.events import Event

__all__ = ["laps_of", "rounds_message", "swings_message", "when_it_ends"]

_MAX_NAMED = 3
"""Number of robots that a sentence names."""
_MIN_SWING = 0.1
"""Distance [m] beside the straight line between waypoints that is worth a word."""


def laps_of(facts: EpisodeFacts) -> dict[str, int]:
    """Number of times that each robot with ``loop`` or ``wander`` came to its last goal, by its name."""
    laps = {record.name: 0 for record in facts.robots.values() if not has_one_end(record) and not record.static}
    for event in facts.events if laps else ():
        if event.kind == "arrival" and event.object in laps:
            laps[event.object] += 1
    return laps


def when_it_ends(robots: Iterable[ObjectRecord]) -> str | None:
    """Say before a run that the first lap of robots without a last goal ends it; None if there are no such robots."""
    all_robots = list(robots)
    endless = [record for record in all_robots if not has_one_end(record) and not record.static]
    if not endless:
        return None
    name, does, unit = listed([quoted(one.name) for one in endless], _MAX_NAMED), _doing(endless), _unit(endless[0])
    if len(all_robots) == 1:
        return f"{name} {does}s: the run ends at its first {unit} (until: time_limit goes on)"
    verb = f"{does}s: it counts" if len(endless) == 1 else f"{does}: each counts"
    return f"{name} {verb} as arrived after its first {unit}, and the run ends when all robots are at goals at once"


def rounds_message(facts: EpisodeFacts, robots: Sequence[RobotResult], until: Until, limit: float) -> str | None:
    """Say how many laps robots made, and that the first one ended the run; None if no robot without a last goal did.

    Of a single robot it is all there is to say about its arrival.

    Args:
        facts: The episode.
        robots: Results of its robots.
        until: Whether the run went on after the first laps.
        limit: Time limit [s].
    """
    laps = {robot.name: robot.laps or 0 for robot in robots if robot.laps}
    endless = [record for record in facts.robots.values() if record.name in laps]
    if not endless:
        return None
    more = f" (until: time_limit goes on to {seconds(limit)})" if until == "done" and facts.time < limit - 1e-9 else ""
    if len(robots) == 1:
        [name], [record] = laps, endless
        first, after = (
            seconds(robots[0].time_to_goal or 0.0),
            ", after a collision" * (robots[0].outcome == "collision"),
        )
        if laps[name] == 1:
            end = ", which ended the run" if more else ""
            return f"the robot {_doing(endless)}s: it made its first {_unit(record)} by {first}{after}{end}{more}"
        return f"the robot made {plural(laps[name], _unit(record))}, the first by {first}{after}{more}"
    names = listed([f"{quoted(one.name)} {plural(laps[one.name], _unit(one))}" for one in endless], _MAX_NAMED)
    end = f", and count as arrived after the first{more}" if more else ""
    return f"robots that {_doing(endless)} made {names}{end}"


def swings_message(facts: EpisodeFacts) -> str | None:
    """Which robot under ``dash`` swung out farthest behind a waypoint, and how far; None if none did."""
    if not facts.is_small or facts.policy is not None:
        return None
    turns: dict[str, list[Event]] = {}
    for event in facts.events:
        if event.kind in ("waypoint", "arrival"):
            turns.setdefault(event.object, []).append(event)
    swings = []
    for row, record in facts.robots.items():
        if (
            len(turns.get(record.name, ())) < 2
            or record.wander
            or getattr(record.active_behavior, "name", "") != "dash"
        ):
            continue
        track = facts.simulation.state.trajectory(row)[:, :2]
        first = facts.steps - len(track) + 1  # step of the first row
        for one, next_one in itertools.pairwise(turns[record.name]):
            leg = track[max(0, one.step - first) : max(0, next_one.step - first) + 1]
            swings.append((_off_line(leg), record, one))
    swings = [swing for swing in swings if swing[0] > max(_MIN_SWING, swing[1].goal_threshold)]
    if not swings:
        return None
    far, record, event = max(swings, key=lambda swing: swing[0])
    corner = min(record.goals, key=lambda goal: math.dist(goal[:2], (event.x, event.y)), default=(event.x, event.y))
    some = len({swing[1].name for swing in swings}) - 1
    more = f", {plural(some, 'other robot')} less" if some else ""
    return (
        f"{quoted(record.name)} swung out by up to {metres(far)} from its straight way, after ({corner[0]:g}, "
        f"{corner[1]:g}) at {seconds(event.time)}{more} (dash turns while driving: lower vel_max[0], raise vel_max[1])"
    )


def _off_line(leg: Floats) -> float:
    """Greatest distance of places (K, 2) from the straight line between the first and the last of them [m]."""
    if len(leg) < 3:
        return 0.0
    way = leg[-1] - leg[0]
    length = float(way @ way)
    share = np.clip((leg - leg[0]) @ way / length, 0.0, 1.0) if length else np.zeros(len(leg))
    return float(np.hypot(*(leg - leg[0] - share[:, None] * way).T).max())


def _doing(endless: Sequence[ObjectRecord]) -> str:
    return "wander" if all(record.wander for record in endless) else "patrol"


def _unit(record: ObjectRecord) -> str:
    """The unit that is counted: goals of a wandering robot, laps round several goals, else trips to and fro."""
    return "goal" if record.wander else "lap" if len(record.goals) > 1 else "trip"
