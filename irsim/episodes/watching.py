"""Zones and fields of view in a run: metrics of robots, zones, and the sentences about both in the summary."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from irsim.common.text import listed, quoted, seconds
from irsim.metrics.watching import Rows, Watching, blocking_objects, goal_visible_ratio, watching_metrics, zone_metrics
from irsim.results.episode import ZoneResult
from irsim.simulation.trace import past_goals, past_poses

if TYPE_CHECKING:
    from irsim.episodes.facts import EpisodeFacts
    from irsim.scenario.model.zones import Zone
    from irsim.simulation.events import Event
    from irsim.simulation.simulation import Simulation

__all__ = ["goal_visibility", "sights_message", "watched_metrics", "zone_results", "zones_message"]

_MAX_NAMES = 10
"""Number of objects that the result of a zone names."""
_MAX_NAMED = 3
"""Number of zones that a sentence names."""


def watched_metrics(facts: EpisodeFacts, arrivals: Mapping[str, Event]) -> dict[str, dict[str, Any]]:
    """Metrics of zones and of fields of view by the name of each robot, until it arrived; None where undefined.

    Args:
        facts: The episode.
        arrivals: First arrivals by name.
    """
    watching = Watching.read(facts.simulation, facts.events)
    watched = {}
    for robot in facts.robots.values():
        last = arrivals[robot.name].step if robot.name in arrivals else facts.steps
        metrics = watching_metrics(watching, robot.name, Rows(0, last + 1, facts.step_time))
        watched[robot.name] = {key: None if math.isnan(value) else value for key, value in metrics.items()}
    return watched


def goal_visibility(facts: EpisodeFacts, arrivals: Mapping[str, Event]) -> dict[str, float | None]:
    """``goal_visible_ratio`` by the name of each robot; None where undefined, and if its past is unknown.

    Args:
        facts: The episode.
        arrivals: First arrivals by name.
    """
    shares: dict[str, float | None] = {}
    blocking = blocking_objects(facts.simulation)
    for row, record in facts.robots.items():
        poses, goals = past_poses(facts.simulation, row), past_goals(facts.simulation, row)
        if record.name in facts.parked or poses is None or goals is None:
            continue
        rows = slice(arrivals[record.name].step + 1 if record.name in arrivals else None)
        share = goal_visible_ratio(poses[rows, :2], goals[rows], facts.simulation, blocking)
        shares[record.name] = None if math.isnan(share) else share
    return shares


def zone_results(simulation: Simulation, events: Sequence[Event]) -> dict[str, ZoneResult]:
    """Entries, crossings and times of all objects in each zone, by the name of the zone."""
    zones = simulation.scenario.world.zones
    if not zones:
        return {}
    watching = Watching.read(simulation, events)
    rows = Rows(0, int(simulation.count[0]) + 1, simulation.scenario.world.step_time)
    of = {name: zone_metrics(watching, name, rows) for name in watching.of_object}
    first: dict[str, dict[str, float]] = {zone.name: {} for zone in zones}
    for event in events:
        if event.zone is not None:
            first[event.zone].setdefault(event.object, event.time)
    robots = {robot.name for robot in simulation.scenario.robots()}
    return {zone.name: _zone_result(zone, first[zone.name], of, robots) for zone in zones}


def _zone_result(
    zone: Zone, first: dict[str, float], of: Mapping[str, Mapping[str, Mapping[str, float]]], robots: Collection[str]
) -> ZoneResult:
    """The result of a zone.

    Args:
        zone: The zone.
        first: Time of the first event of each object at the zone, by its name, in order.
        of: Metrics of all zones by the name of the object.
        robots: Names of all robots.
    """

    def total(key: str) -> float:
        return math.fsum(of[name][zone.name][key] for name in first)

    return ZoneResult(
        objects=len(first),
        names=list(first)[:_MAX_NAMES],
        robots=[name for name in first if name in robots][:_MAX_NAMES],
        first_time=next(iter(first.values()), None),
        entries=None if zone.is_line else int(total("zone_crossings")),
        time_in_zone=None if zone.is_line else total("time_in_zone"),
        left_to_right=int(total("left_to_right")) if zone.is_line else None,
        right_to_left=int(total("right_to_left")) if zone.is_line else None,
    )


def zones_message(zones: Mapping[str, ZoneResult]) -> str | None:
    """Say which zones were entered or crossed, how often, by which object first, and which were not; None: no zones."""
    parts = [_zone_message(name, zone) for name, zone in zones.items() if zone.objects]
    empty = [quoted(name) for name, zone in zones.items() if not zone.objects]
    parts += [f"nothing was in {listed(empty, _MAX_NAMED)}"] if empty else []
    return listed(parts, _MAX_NAMED) if parts else None


def _zone_message(name: str, zone: ZoneResult) -> str:
    first = f"first {quoted(zone.names[0])} at {seconds(zone.first_time or 0.0)}"
    if zone.robots and zone.robots[0] != zone.names[0]:
        first += f", the robot {quoted(zone.robots[0])} later"
    if zone.time_in_zone is not None:
        objects = "1 object" if zone.objects == 1 else f"{zone.objects} objects"
        return f"{quoted(name)}: {objects} for {seconds(zone.time_in_zone)} ({first})"
    crossings = (zone.left_to_right or 0) + (zone.right_to_left or 0)
    return f"{quoted(name)}: crossed {'once' if crossings == 1 else f'{crossings} times'} ({first})"


def sights_message(events: Sequence[Event]) -> str | None:
    """Say which object saw another first, and how many such pairs there are; None if none did."""
    pairs: dict[tuple[str, str | None], float] = {}
    for event in events:
        if event.kind == "sight_start":
            pairs.setdefault((event.object, event.partner), event.time)
    if not pairs:
        return None
    (observer, seen), time = next(iter(pairs.items()))
    more = f" (the first of {len(pairs)} such pairs)" if len(pairs) > 1 else ""
    return f"{quoted(observer)} saw {quoted(seen)} at {seconds(time)}{more}"
