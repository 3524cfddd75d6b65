"""The trajectory of one robot up to its first arrival, cut out of a trace."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irsim.common.angles import wrap
from irsim.common.arrays import Floats
from irsim.navigation.clearances import Clearance, static_distance
from irsim.simulation.events import (
    BETWEEN_STEPS,
    Event,
    first_events,
    is_between_steps_of,
    is_collision_of,
    partner_of,
)
from irsim.simulation.roles import HUMAN, kinds_of, social_groups

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation
    from irsim.simulation.trace import Trace

__all__ = ["Track", "thin_path", "tracks"]

_POINT_SPACING_M = 0.05
"""Least distance [m] of the path points from which directions and curvatures are computed."""


@dataclass(frozen=True)
class Track:
    """Trajectory of one robot up to its first arrival, or to the end of the trace.

    Attributes:
        name: Name of the robot.
        index: Index of the robot among the objects.
        first: Step of the first row, in which it came into the world.
        step_time: Period [s].
        pose: (K, 3) x, y [m], heading [rad], world frame; row 0 is the start. NaN if it never came into the world.
        goal: (K, 3) present goal; NaN without one.
        collided: (K,) whether the robot touches an object that blocks it.
        stopped: Whether a contact keeps it from moving at the last row.
        distance: (K, 3) distance [m] to the nearest robot, human, static object (see ``Clearance``).
        arrival: Step of the first arrival, None if it never arrived.
        collisions: Contacts up to the arrival, each with the kind of the partner (see :mod:`irsim.simulation.roles`).
        between_steps: Number of contacts up to the arrival that began and ended within one step.
        control: (K - 1, C) controls executed in each step.
        limits: (C,) greatest magnitude of each control.
        outside: (K,) whether its position is outside the world.
        others: (K, M, 3) poses of the humans; NaN before they came into the world.
        others_static: (K, M) distance of each human to the nearest static object [m].
        people: Names of the humans.
        groups: Members of each social group, as columns of ``others``.
        reaches: (M,) bounding radii of the humans [m].
        reach: Bounding radius of the robot [m].
        top_speed: Greatest speed limit, forward or sideways [m/s].
        holonomic: Whether it can move in another direction without turning.
        believed: Whether it believed at some time to have arrived; None if it does not go by an estimate.
    """

    name: str
    index: int
    first: int
    step_time: float
    pose: Floats
    goal: Floats
    collided: NDArray[np.bool_]
    stopped: bool
    distance: Floats
    arrival: int | None
    collisions: tuple[tuple[Event, int], ...]
    between_steps: int
    control: Floats
    limits: Floats
    outside: NDArray[np.bool_]
    others: Floats
    others_static: Floats
    people: tuple[str, ...]
    groups: tuple[tuple[int, ...], ...]
    reaches: Floats
    reach: float
    top_speed: float
    holonomic: bool
    believed: bool | None = None

    @property
    def position(self) -> Floats:
        """(K, 2) positions [m], world frame."""
        return self.pose[:, :2]

    @property
    def velocity(self) -> Floats:
        """(K - 1, 2) velocity during each step [m/s], world frame."""
        return np.diff(self.position, axis=0) / self.step_time

    @property
    def speed(self) -> Floats:
        """(K - 1,) speed during each step [m/s]."""
        return np.asarray(np.linalg.norm(self.velocity, axis=1))

    @property
    def turning(self) -> Floats:
        """(K - 1,) heading change during each step [rad], in [-pi, pi)."""
        return wrap(np.diff(self.pose[:, 2]))

    @property
    def bends(self) -> Floats:
        """Changes of direction along the path [rad], in [-pi, pi).

        They are the heading changes of each step. For a holonomic drive, whose heading is free, they are changes of
        the direction of motion, computed from path points that are at least 0.05 m apart.
        """
        if not self.holonomic:
            return self.turning
        legs = np.diff(thin_path(self.position), axis=0)
        return wrap(np.diff(np.arctan2(legs[:, 1], legs[:, 0])))

    @property
    def path_length(self) -> float:
        """Distance travelled [m]."""
        return float(np.linalg.norm(np.diff(self.position, axis=0), axis=1).sum())

    @property
    def success(self) -> bool:
        """Whether the robot arrived without a contact before."""
        return self.arrival is not None and not self.collisions


def thin_path(points: Floats) -> Floats:
    """Thin the (T, 2) points of a path to (K, 2) points of which each is at least 0.05 m from the one before it."""
    kept = [0]
    x, y = points[:, 0].tolist(), points[:, 1].tolist()
    for row in range(1, len(x)):
        if math.hypot(x[row] - x[kept[-1]], y[row] - y[kept[-1]]) >= _POINT_SPACING_M:
            kept.append(row)
    return points[kept]


def tracks(
    trace: Trace,
    events: list[Event],
    distances: Clearance,
    simulation: Simulation,
) -> list[Track]:
    """Cut a trace into the tracks of its robots.

    Args:
        trace: Trace of the episode.
        events: Events of the episode.
        distances: Clearances of the robots.
        simulation: The simulation with the scene of the trace.
    """
    scenario = simulation.scenario
    records = scenario.objects
    kinds, groups = kinds_of(records), social_groups(records)
    passable = {record.name for record in records if record.unobstructed}
    number = {name: index for index, name in enumerate(trace.names)}
    arrivals, beliefs = first_events(events, "arrival"), first_events(events, "believed_arrival")
    brief = [event for event in events if event.kind in BETWEEN_STEPS]
    humans = np.flatnonzero(kinds == HUMAN)
    beside = static_distance(trace.pose, simulation, humans.tolist())
    first, radii = int(trace.step[0]), np.asarray(simulation.radius[: simulation.objects], dtype=np.float64)
    result = []
    for place, robot in enumerate(distances.robots.tolist()):
        name = trace.names[robot]
        arrival = arrivals[name].step if name in arrivals else None
        end = len(trace) if arrival is None else arrival - first + 1
        there = np.flatnonzero(~np.isnan(trace.pose[:end, robot, 0]))
        begin = int(there[0]) if len(there) else end - 1  # it is measured from when it came into the world
        rows = slice(begin, end)
        hits = []
        for event in events:
            if is_collision_of(event, name, passable) and (arrival is None or event.step <= arrival):
                other = partner_of(event, name)
                hits.append((event, int(kinds[number[str(other)]])))
        them = humans[humans != robot]
        column = {human: place for place, human in enumerate(them.tolist())}
        together = [tuple(column[one] for one in group if one in column) for group in groups]
        record = records[robot]
        x, y = trace.pose[rows, robot, 0], trace.pose[rows, robot, 1]
        x0, y0, x1, y1 = scenario.world.bounds
        result.append(
            Track(
                name=name,
                index=robot,
                first=first + begin,
                step_time=trace.step_time,
                pose=trace.pose[rows, robot],
                goal=trace.goal[rows, robot],
                collided=trace.collided[rows, robot],
                stopped=bool(trace.stopped[rows, robot][-1]),
                distance=distances.distance[rows, place],
                arrival=arrival,
                collisions=tuple(hits),
                between_steps=sum(
                    is_between_steps_of(event, name, passable) and (arrival is None or event.step <= arrival)
                    for event in brief
                ),
                control=trace.control[rows, robot, : record.vel_dim][1:],
                limits=np.maximum(*np.abs(simulation.limits(robot))),
                outside=(x < x0) | (x > x1) | (y < y0) | (y > y1),
                others=trace.pose[rows][:, them],
                others_static=beside[rows][:, humans != robot],
                people=tuple(trace.names[human] for human in them),
                groups=tuple(group for group in together if len(group) > 1),
                reaches=radii[them],
                reach=float(radii[robot]),
                top_speed=_top_speed(simulation.limits(robot)[1], record.kinematics),
                holonomic=getattr(record.kinematics, "speeds", 0) == 2,
                believed=name in beliefs if record.perceives in ("estimate", "both") else None,
            )
        )
    return result


def _top_speed(vel_max: Floats, kinematics: object) -> float:
    if kinematics is None:
        return 0.0
    # not the norm of both: most behaviors never use both at once
    return float(max(vel_max[:2]) if getattr(kinematics, "speeds", 0) == 2 else vel_max[0])
