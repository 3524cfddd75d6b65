"""Metrics of zones and of sight: who was where, who was seen, who saw its goal. They follow from events and poses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.simulation.build import is_watching
from irsim.simulation.events import SIGHTS
from irsim.simulation.roles import STATIC, kinds_of

if TYPE_CHECKING:
    from irsim.scenario.model.zones import Zone
    from irsim.simulation.events import Event
    from irsim.simulation.simulation import Simulation

__all__ = ["Rows", "Watching", "blocking_objects", "goal_visible_ratio", "watching_metrics", "zone_metrics"]

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Watching:
    """Zones, observers and their events in an episode.

    Attributes:
        zones: The zones.
        observers: Names of the objects with a watched field of view.
        of_object: Events of zones by the name of the object.
        of_seen: Events of sights by the name of the object that is seen.
    """

    zones: Sequence[Zone]
    observers: frozenset[str]
    of_object: dict[str, list[Event]] = field(default_factory=dict)
    of_seen: dict[str, list[Event]] = field(default_factory=dict)

    @classmethod
    def read(cls, simulation: Simulation, events: Sequence[Event]) -> Watching:
        """Sort the events of an episode."""
        scenario = simulation.scenario
        observers = frozenset(record.name for record in scenario.objects if is_watching(record))
        watching = cls(scenario.world.zones, observers)
        for event in events:
            if event.zone is not None:
                watching.of_object.setdefault(event.object, []).append(event)
            elif event.kind in SIGHTS:
                watching.of_seen.setdefault(str(event.partner), []).append(event)
        return watching


@dataclass(frozen=True)
class Rows:
    """The part of an episode over which an object is measured.

    Attributes:
        first: Step of the first row.
        count: Number of rows, one per step.
        step_time: Period [s].
    """

    first: int
    count: int
    step_time: float

    def marked(self, changes: Sequence[tuple[int, int]]) -> NDArray[np.int64]:
        """(K,) sums, at each row, of changes given as (step, change)."""
        sums = np.zeros(self.count, dtype=np.int64)
        for step, change in changes:
            if step < self.first + self.count:
                sums[max(0, step - self.first) :] += change
        return sums

    def seconds(self, rows: Flags) -> float:
        """Time [s] that begins with the rows of a flag; none begins with the last row."""
        return float(np.count_nonzero(rows[:-1])) * self.step_time

    def includes(self, event: Event) -> bool:
        """Whether an event is one of a step in these rows, not of the state before the first step."""
        return event.step > 0 and self.first <= event.step < self.first + self.count


def watching_metrics(watching: Watching, name: str, rows: Rows) -> dict[str, float]:
    """Metrics of the zones that a robot was in and of the objects that saw it, until it arrived.

    - ``time_in_zone`` [s]: time in which its footprint overlaps one of the regions of ``world.zones``, touching
      included; NaN without regions.
    - ``zone_crossings``: entries into regions after the start, plus crossings of lines by its centre, signed: +1 from
      left to right of the line, -1 from right to left; NaN without zones.
    - ``seen_ratio``: share of rows in which it is in the field of view of at least one other object, with occlusion if
      that object has ``fov_occlusion``. Only fields of view that the scenario gives with ``fov`` count, not the
      range of a lidar. NaN if no other object has one.

    Args:
        watching: Zones and observers.
        name: Name of the robot.
        rows: Rows up to its arrival.
    """
    regions = [zone.name for zone in watching.zones if not zone.is_line]
    inside = np.zeros(rows.count, dtype=bool)
    for zone in regions:
        inside |= _inside(watching, name, zone, rows)
    crossings = [zone["zone_crossings"] for zone in zone_metrics(watching, name, rows).values()]
    changes = [(event.step, 1 if event.kind == "sight_start" else -1) for event in watching.of_seen.get(name, ())]
    seen = rows.marked(changes) > 0
    return {
        "time_in_zone": rows.seconds(inside) if regions else math.nan,
        "zone_crossings": math.fsum(crossings) if crossings else math.nan,
        "seen_ratio": float(seen.mean()) if watching.observers - {name} else math.nan,
    }


def zone_metrics(watching: Watching, name: str, rows: Rows) -> dict[str, dict[str, float]]:
    """The metrics of each zone by its name: ``zone_crossings``, and ``time_in_zone`` [s] of a region.

    For a line there are ``left_to_right`` and ``right_to_left`` too, of which ``zone_crossings`` is the difference.
    """
    metrics: dict[str, dict[str, float]] = {}
    for zone in watching.zones:
        mine = [e for e in watching.of_object.get(name, ()) if e.zone == zone.name and rows.includes(e)]
        if zone.is_line:
            right = float(sum(event.direction == "left_to_right" for event in mine))
            left = float(sum(event.direction == "right_to_left" for event in mine))
            metrics[zone.name] = {"zone_crossings": right - left, "left_to_right": right, "right_to_left": left}
        else:
            entries = float(sum(event.kind == "zone_entry" for event in mine))
            seconds = rows.seconds(_inside(watching, name, zone.name, rows))
            metrics[zone.name] = {"time_in_zone": seconds, "zone_crossings": entries}
    return metrics


def blocking_objects(simulation: Simulation) -> NDArray[np.uint8]:
    """(N,) whether each object hides goals: obstacles that never move, maps and the walls, unless ``unobstructed``."""
    records = simulation.scenario.objects
    static = np.array([record.static for record in records], dtype=bool)
    return np.asarray(static & (kinds_of(records) == STATIC), dtype=np.uint8)


def goal_visible_ratio(
    positions: Floats, goals: Floats, simulation: Simulation, blocking: NDArray[np.uint8], world: int = 0
) -> float:
    """Share of rows in which the straight line from the centre of a robot to its goal meets no static object.

    Touching one blocks the line.

    Args:
        positions: (K, 2) positions of the robot [m].
        goals: (K, 3) its goals; rows without a goal (NaN) do not count.
        simulation: The simulation with the scene of the positions.
        blocking: (N,) the objects that block the line (:func:`blocking_objects`).
        world: Index of one of its worlds.

    Returns:
        The share; NaN if no row has a goal.
    """
    known = ~np.isnan(goals[:, :2]).any(axis=1)
    if not known.any():
        return math.nan
    if not blocking.any():
        return 1.0
    free = core.free_lines(
        simulation.world,
        simulation.state,
        world,
        np.ascontiguousarray(positions[known], dtype=np.float64),
        np.ascontiguousarray(goals[known, :2], dtype=np.float64),
        blocking,
    )
    return float(np.mean(free))


def _inside(watching: Watching, name: str, zone: str, rows: Rows) -> Flags:
    """(K,) whether an object overlaps a region."""
    mine = (event for event in watching.of_object.get(name, ()) if event.zone == zone)
    return rows.marked([(event.step, 1 if event.kind == "zone_entry" else -1) for event in mine]) > 0
