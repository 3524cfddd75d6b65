"""One robot's part of a trace, until it arrived."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from irsim.metrics.clearance import Clearance
    from irsim.observers.events import Event
    from irsim.observers.trace import Trace

__all__ = ["Track", "tracks"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Track:
    """Rows 0 to the first arrival of one robot, or to the end of the trace.

    Attributes:
        name: Of the robot.
        index: Among the objects.
        step_time: Period [s].
        pose: (K, 3) x, y [m], heading [rad], world frame; row 0 is the start.
        goal: (K, 3) present goal; NaN without one.
        collided: (K,) in contact with something that stands in the way.
        distance: (K, 3) distance [m] to the nearest robot, human, static thing (see ``Clearance``).
        arrival: Step of the first arrival, None if it never arrived.
        collisions: Its contacts until then, with the kind of each (a number of :mod:`irsim.metrics.company`).
        others: (K, M, 3) poses of the humans.
        reaches: (M,) bounding radii of the humans [m].
        reach: Its own bounding radius [m].
        top_speed: What it may do at most [m/s].
    """

    name: str
    index: int
    step_time: float
    pose: Floats
    goal: Floats
    collided: NDArray[np.bool_]
    distance: Floats
    arrival: int | None
    collisions: tuple[tuple[Event, int], ...]
    others: Floats
    reaches: Floats
    reach: float
    top_speed: float

    @property
    def position(self) -> Floats:
        """(K, 2) [m]."""
        return self.pose[:, :2]

    @property
    def velocity(self) -> Floats:
        """(K - 1, 2) velocity during each step [m/s], world frame."""
        return np.diff(self.position, axis=0) / self.step_time

    @property
    def speed(self) -> Floats:
        """(K - 1,) [m/s]."""
        return np.asarray(np.linalg.norm(self.velocity, axis=1))

    @property
    def turning(self) -> Floats:
        """(K - 1,) heading change of each step [rad], in [-pi, pi)."""
        turned = np.diff(self.pose[:, 2])
        return np.asarray((turned + np.pi) % (2 * np.pi) - np.pi)

    @property
    def path_length(self) -> float:
        """Distance travelled [m]."""
        return float(np.linalg.norm(np.diff(self.position, axis=0), axis=1).sum())

    @property
    def success(self) -> bool:
        """Arrived, and no contact until then."""
        return self.arrival is not None and not self.collisions


def tracks(
    trace: Trace,
    events: list[Event],
    distances: Clearance,
    kinds: NDArray[np.uint8],
    radii: Floats,
    top_speeds: list[float],
    passable: set[str],
) -> list[Track]:
    """Cut a trace into the tracks of its robots.

    Args:
        trace: The episode.
        events: What happened in it.
        distances: Of the robots.
        kinds: (N,) who is who (:func:`irsim.metrics.company.company_of`).
        radii: (N,) bounding radii [m].
        top_speeds: Of the robots [m/s].
        passable: Names of what is ``unobstructed``.
    """
    from irsim.observers.events import collision_of, first_events

    number = {name: index for index, name in enumerate(trace.names)}
    arrivals = first_events(events, "arrival")
    humans = np.flatnonzero(kinds == 1)
    first = int(trace.step[0])
    found = []
    for place, robot in enumerate(distances.robots.tolist()):
        name = trace.names[robot]
        arrival = arrivals[name].step if name in arrivals else None
        rows = slice(0, len(trace) if arrival is None else arrival - first + 1)
        hits = []
        for event in events:
            if collision_of(event, name, passable) and (arrival is None or event.step <= arrival):
                other = event.partner if event.object == name else event.object
                hits.append((event, int(kinds[number[str(other)]])))
        them = humans[humans != robot]
        found.append(
            Track(
                name=name,
                index=robot,
                step_time=trace.step_time,
                pose=trace.pose[rows, robot],
                goal=trace.goal[rows, robot],
                collided=trace.collided[rows, robot],
                distance=distances.distance[rows, place],
                arrival=arrival,
                collisions=tuple(hits),
                others=trace.pose[rows][:, them],
                reaches=radii[them],
                reach=float(radii[robot]),
                top_speed=top_speeds[place],
            )
        )
    return found
