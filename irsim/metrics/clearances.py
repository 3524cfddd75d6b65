"""Clearances over a trace: distances between the footprints of robots and of robots, humans and static objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.metrics.roles import IGNORED, KINDS, STATIC, kinds_of
from irsim.simulation.simulation import Simulation

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["Approach", "Clearance", "approaches", "clearance", "closest", "least", "static_distance"]

_MAX_WORK = 20_000_000
"""Number of footprints placed, up to which more than the nearest object of each kind is found."""


class Posed(Protocol):
    """A trace, of which only the poses are needed."""

    @property
    def pose(self) -> NDArray[np.float64]:
        """(T, N, 3) x, y [m] and heading [rad], world frame."""
        ...


@dataclass(frozen=True, slots=True)
class Clearance:
    """Distances of R robots over T rows of a trace to the nearest other robot, human and static thing.

    Attributes:
        distance: (T, R, 3) distance between footprints [m] to the nearest robot, human and static thing, in this order
            (:data:`irsim.metrics.roles.KINDS`); negative where they overlap, NaN where there is none of the kind.
        partner: (T, R, 3) which object that is, an index into ``names``; -1 where there is none.
        robots: (R,) indices of the robots.
        names: Names of the N objects.
    """

    distance: NDArray[np.float64]
    partner: NDArray[np.int32]
    robots: NDArray[np.int64]
    names: tuple[str, ...]

    @property
    def robot(self) -> NDArray[np.float64]:
        """(T, R) distance to the nearest other robot [m]."""
        return self.distance[:, :, 0]

    @property
    def human(self) -> NDArray[np.float64]:
        """(T, R) distance to the nearest human [m]."""
        return self.distance[:, :, 1]

    @property
    def static(self) -> NDArray[np.float64]:
        """(T, R) distance to the nearest static object [m]: obstacle, map or wall around the world."""
        return self.distance[:, :, 2]


@dataclass(frozen=True, slots=True)
class Approach:
    """The closest approach of an object to another.

    Attributes:
        row: Row of the trace.
        distance: Distance between the footprints [m]; negative: overlap.
        partner: Name of the other object.
        kind: Kind of the other object: ``robot``, ``human`` or ``static``.
    """

    row: int
    distance: float
    partner: str
    kind: str


def clearance(
    trace: Posed | NDArray[np.float64], scenario: ResolvedScenario | Simulation, *, seed: int = 0, world: int = 0
) -> Clearance:
    """Distances between the true footprints, in every row of a trace.

    Objects that are ``unobstructed`` have no distances, as others pass through them. A map counts as its occupied
    cells, ``world.boundary: walls`` as the line around the world. The depth of an overlap is that of the deepest
    corner of one outline inside the other.

    Args:
        trace: A trace, or its (T, N, 3) poses.
        scenario: The scenario that was simulated, or the simulation with the scene of the trace.
        seed: With a scenario: the seed of the run, which determines random shapes.
        world: With a simulation: the index of one of its worlds.
    """
    simulation = scenario if isinstance(scenario, Simulation) else Simulation(scenario, [seed])
    records = simulation.scenario.objects
    poses = trace if isinstance(trace, np.ndarray) else trace.pose
    robots = [index for index, record in enumerate(records) if record.role == "robot"]
    distance, partner = core.clearances(
        simulation.world,
        simulation.state,
        world,
        np.ascontiguousarray(poses, dtype=np.float64),
        robots,
        kinds_of(records),
    )
    names = tuple(record.name for record in records)
    return Clearance(distance, partner, np.asarray(robots, dtype=np.int64), names)


def static_distance(poses: NDArray[np.float64], simulation: Simulation, objects: Sequence[int]) -> NDArray[np.float64]:
    """(T, M) distance between footprints [m] of some objects to the nearest static object; NaN without any.

    Args:
        poses: (T, N, 3) poses of all objects.
        simulation: The simulation with the scene of the poses; its first world counts.
        objects: Indices of the M objects.
    """
    company = kinds_of(simulation.scenario.objects)
    company[company != STATIC] = IGNORED
    if not len(objects) or (company == IGNORED).all():
        return np.full((len(poses), len(objects)), np.nan)
    poses = np.ascontiguousarray(poses, dtype=np.float64)
    distance, _ = core.clearances(simulation.world, simulation.state, 0, poses, list(objects), company)
    return distance[:, :, STATIC]


def closest(distances: Clearance) -> list[Approach | None]:
    """Closest approach of each robot to any object, the first of equal ones; None if there is no other object."""
    found: list[Approach | None] = []
    for robot in range(len(distances.robots)):
        table = distances.distance[:, robot]
        if not np.isfinite(table).any():
            found.append(None)
            continue
        row, kind = np.unravel_index(np.nanargmin(table), table.shape)
        partner = distances.names[distances.partner[row, robot, kind]]
        found.append(Approach(int(row), float(table[row, kind]), partner, KINDS[kind]))
    return found


def approaches(
    trace: Posed | NDArray[np.float64],
    scenario: ResolvedScenario | Simulation,
    objects: Sequence[int],
    most: int,
    *,
    seed: int = 0,
) -> list[list[Approach]]:
    """Closest approaches of some objects to others, the closest first.

    Args:
        trace: A trace, or its (T, N, 3) poses.
        scenario: The scenario that was simulated, or the simulation with the scene of the trace.
        objects: Indices of robots or other objects.
        most: Greatest number of other objects of each kind (robot, human, static); fewer if there are very many objects
            and rows.
        seed: With a scenario: the seed of the run, which determines random shapes.
    """
    simulation = scenario if isinstance(scenario, Simulation) else Simulation(scenario, [seed])
    records = simulation.scenario.objects
    poses = np.ascontiguousarray(trace if isinstance(trace, np.ndarray) else trace.pose, dtype=np.float64)
    rounds = max(1, min(most, _MAX_WORK // max(1, len(poses) * len(records) * len(objects))))
    found = []
    for index in objects:
        company, mine = kinds_of(records), list[Approach]()
        for _ in range(rounds):
            distance, partner = core.clearances(simulation.world, simulation.state, 0, poses, [index], company)
            known = len(mine)
            for kind, table in enumerate(distance[:, 0].T):
                if np.isfinite(table).any():
                    row = int(np.nanargmin(table))
                    other = int(partner[row, 0, kind])
                    mine.append(Approach(row, float(table[row]), records[other].name, KINDS[kind]))
                    company[other] = IGNORED  # the next round finds the next nearest
            if len(mine) == known:
                break
        found.append(sorted(mine, key=lambda approach: approach.distance))
    return found


def least(
    poses: NDArray[np.float64], simulation: Simulation, robots: Sequence[int], ends: Sequence[int], world: int = 0
) -> list[Approach | None]:
    """Closest approach of each of some objects to any other, computed faster than all clearances; None without any.

    Args:
        poses: (T, N, 3) poses of all objects.
        simulation: The simulation with the scene of the poses.
        robots: Indices of the objects.
        ends: For each of them the number of rows that count.
        world: Index of one of the worlds.
    """
    records = simulation.scenario.objects
    company = kinds_of(records)
    found = core.least_clearances(simulation.world, simulation.state, world, poses, robots, company, ends)
    return [
        None if partner < 0 else Approach(row, distance, records[partner].name, KINDS[company[partner]])
        for distance, partner, row in zip(*(column.tolist() for column in found), strict=True)
    ]
