"""Clearances over a trace: distances between the footprints of robots and of robots, humans and static objects."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.simulation.roles import HUMAN, IGNORED, KINDS, STATIC, kinds_of
from irsim.simulation.simulation import Simulation

if TYPE_CHECKING:
    from irsim.objects.view import ObjectView
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = [
    "Approach",
    "Clearance",
    "approaches",
    "clearance",
    "closest",
    "least",
    "standing_distance",
    "static_distance",
]

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
            (:data:`irsim.simulation.roles.KINDS`); negative where they overlap, NaN where there is none of the kind.
        partner: (T, R, 3) which object that is, an index into ``names``; -1 without one.
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
    cells, ``world.boundary: walls`` as the line around the world. The depth of an overlap is the depth of the
    deepest corner of one outline inside the other.

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
    distance, partner = _clearances(simulation, world, poses, robots, kinds_of(records))
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
    distance, _ = _clearances(simulation, 0, poses, list(objects), company)
    return distance[:, :, STATIC]


def standing_distance(
    simulation: Simulation, view: ObjectView, poses: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """(P,) distances [m] of a footprint at some poses to the nearest object that stands, and which (P,) object that is.

    Objects that stand are static objects, maps, walls around the world and people that never move. Distances are
    negative where footprints overlap; without any such object they are NaN, and the objects -1.

    Args:
        simulation: The simulation with the other objects.
        view: The object with the footprint.
        poses: (P, 3) poses of the footprint: x, y [m] and heading [rad].
    """
    records, first = simulation.scenario.objects, view.row - view.row % simulation.objects
    stands = [
        kind in (STATIC, HUMAN) and record.static for kind, record in zip(kinds_of(records), records, strict=True)
    ]
    company = np.where(stands, STATIC, IGNORED).astype(np.uint8)
    index = view.row - first
    company[index] = IGNORED
    if (company == IGNORED).all():
        return np.full(len(poses), np.nan), np.full(len(poses), -1, dtype=np.int32)
    places = np.repeat(simulation.pose[None, first : first + simulation.objects, :3], len(poses), axis=0)
    places[:, index] = poses
    distance, partner = _clearances(simulation, first // simulation.objects, places, [index], company)
    return distance[:, 0, STATIC], partner[:, 0, STATIC]


def closest(distances: Clearance) -> list[Approach | None]:
    """Closest approach of each robot to any object, the first of equal ones; None if there is no other object."""
    nearest: list[Approach | None] = []
    for robot in range(len(distances.robots)):
        table = distances.distance[:, robot]
        if not np.isfinite(table).any():
            nearest.append(None)
            continue
        row, kind = np.unravel_index(np.nanargmin(table), table.shape)
        partner = distances.names[distances.partner[row, robot, kind]]
        nearest.append(Approach(int(row), float(table[row, kind]), partner, KINDS[kind]))
    return nearest


def approaches(
    trace: Posed | NDArray[np.float64],
    scenario: ResolvedScenario | Simulation,
    objects: Sequence[int],
    most: int,
    *,
    seed: int = 0,
) -> list[list[Approach]]:
    """Closest approaches of some objects to other objects, the closest first.

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
    listed = []
    for index in objects:
        company, mine = kinds_of(records), list[Approach]()
        for _ in range(rounds):
            distance, partner = _clearances(simulation, 0, poses, [index], company)
            known = len(mine)
            for kind, table in enumerate(distance[:, 0].T):
                if np.isfinite(table).any():
                    row = int(np.nanargmin(table))
                    other = int(partner[row, 0, kind])
                    mine.append(Approach(row, float(table[row]), records[other].name, KINDS[kind]))
                    company[other] = IGNORED  # the next round finds the next nearest
            if len(mine) == known:
                break
        listed.append(sorted(mine, key=lambda approach: approach.distance))
    return listed


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
    best: list[Approach | None] = [None] * len(robots)
    for rows, absent in _stretches(poses):
        present = [place for place, robot in enumerate(robots) if not absent[robot] and ends[place] > rows.start]
        columns = core.least_clearances(
            simulation.world,
            simulation.state,
            world,
            poses[rows],
            [robots[place] for place in present],
            np.where(absent, IGNORED, company).astype(company.dtype),
            [ends[place] - rows.start for place in present],
        )
        for place, distance, partner, row in zip(present, *(column.tolist() for column in columns), strict=True):
            before = best[place]
            if partner >= 0 and (before is None or distance < before.distance):
                best[place] = Approach(rows.start + row, distance, records[partner].name, KINDS[company[partner]])
    return best


def _stretches(poses: NDArray[np.float64]) -> Iterator[tuple[slice, NDArray[np.bool_]]]:
    """Rows in which the same objects are absent, with NaN for their positions, and which (N,) objects these are."""
    absent = np.isnan(poses[:, :, 0])
    changes = np.flatnonzero((absent[1:] != absent[:-1]).any(axis=1)) + 1
    for begin, end in itertools.pairwise([0, *changes.tolist(), len(poses)]):
        yield slice(begin, end), absent[begin] if end > begin else np.zeros(poses.shape[1], dtype=bool)


def _clearances(
    simulation: Simulation, world: int, poses: NDArray[np.float64], objects: list[int], company: NDArray[np.uint8]
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """(T, M, 3) distances of M objects to the nearest object of each kind, NaN without one, and which that is, or -1.

    Args:
        simulation: The simulation with the scene of the poses.
        world: Index of one of its worlds.
        poses: (T, N, 3) poses of all objects, NaN before an object came into the world.
        objects: Indices of the M objects.
        company: (N,) kind of each object.
    """
    poses = np.ascontiguousarray(poses, dtype=np.float64)
    distances, partners = [], []
    for rows, absent in _stretches(poses):
        kinds = np.where(absent, IGNORED, company).astype(company.dtype)
        distance, partner = core.clearances(simulation.world, simulation.state, world, poses[rows], objects, kinds)
        missing = absent[objects]
        if missing.any():
            distance[:, missing], partner[:, missing] = np.nan, -1
        distances.append(distance)
        partners.append(partner)
    return (distances[0], partners[0]) if len(distances) == 1 else (np.concatenate(distances), np.concatenate(partners))
