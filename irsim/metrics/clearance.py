"""How near robots came to robots, people and what stands still: distances between footprints over a trace."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.metrics.roles import KINDS, NOBODY, STATIC, company_of
from irsim.simulation.simulation import Simulation

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["Approach", "Clearance", "approaches", "clearance", "closest", "least", "static_distance"]

_MOST_WORK = 20_000_000
"""Bodies placed at most to tell more than the nearest of each kind."""


class Posed(Protocol):
    """A trace, as far as distances go."""

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
        """(T, R) distance to the nearest static thing [m]: obstacles, maps, walls round the world."""
        return self.distance[:, :, 2]


@dataclass(frozen=True, slots=True)
class Approach:
    """The moment at which an object was closest to another.

    Attributes:
        row: Row of the trace.
        distance: Between the footprints [m]; negative: overlap.
        partner: Name of what it was close to.
        kind: ``robot``, ``human`` or ``static``.
    """

    row: int
    distance: float
    partner: str
    kind: str


def clearance(
    trace: Posed | NDArray[np.float64], scenario: ResolvedScenario | Simulation, *, seed: int = 0, world: int = 0
) -> Clearance:
    """Distances between the true footprints, in every row of a trace.

    What is ``unobstructed`` is passed through and has no distance. Circles are circles; a map is its occupied cells and
    ``world.boundary: walls`` the line round the world. Of two overlapping outlines the depth is that of the deepest
    corner of one inside the other.

    Args:
        trace: With ``pose``, or the (T, N, 3) poses themselves.
        scenario: What was simulated; or the simulation, in the scene that the trace is of.
        seed: With a scenario: the seed of the run, which decides random shapes.
        world: With a simulation: which of its worlds.
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
        company_of(records),
    )
    names = tuple(record.name for record in records)
    return Clearance(distance, partner, np.asarray(robots, dtype=np.int64), names)


def static_distance(poses: NDArray[np.float64], simulation: Simulation, objects: Sequence[int]) -> NDArray[np.float64]:
    """(T, M) distance between footprints [m] of some objects to the nearest static thing; NaN where there is none.

    Args:
        poses: (T, N, 3) as in :func:`clearance`.
        simulation: In the scene that they are of; its first world.
        objects: Whose, as indices.
    """
    company = company_of(simulation.scenario.objects)
    company[company != STATIC] = NOBODY
    if not len(objects) or (company == NOBODY).all():
        return np.full((len(poses), len(objects)), np.nan)
    poses = np.ascontiguousarray(poses, dtype=np.float64)
    distance, _ = core.clearances(simulation.world, simulation.state, 0, poses, list(objects), company)
    return distance[:, :, STATIC]


def closest(distances: Clearance) -> list[Approach | None]:
    """For each robot the moment at which it was closest to anything; the first of equal ones. None without anything."""
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
    """For each of some objects the nearest others, each at its closest moment, the nearest first.

    Args:
        trace: As in :func:`clearance`.
        scenario: As there.
        objects: Whose, as indices: robots or others.
        most: Others at most of each kind (robots, humans, static things); only one where there are very many objects
            and rows.
        seed: With a scenario: the seed of the run, which decides random shapes.
    """
    simulation = scenario if isinstance(scenario, Simulation) else Simulation(scenario, [seed])
    records = simulation.scenario.objects
    poses = np.ascontiguousarray(trace if isinstance(trace, np.ndarray) else trace.pose, dtype=np.float64)
    rounds = max(1, min(most, _MOST_WORK // max(1, len(poses) * len(records) * len(objects))))
    found = []
    for index in objects:
        company, mine = company_of(records), list[Approach]()
        for _ in range(rounds):
            distance, partner = core.clearances(simulation.world, simulation.state, 0, poses, [index], company)
            known = len(mine)
            for kind, table in enumerate(distance[:, 0].T):
                if np.isfinite(table).any():
                    row = int(np.nanargmin(table))
                    other = int(partner[row, 0, kind])
                    mine.append(Approach(row, float(table[row]), records[other].name, KINDS[kind]))
                    company[other] = NOBODY  # the next round finds the next
            if len(mine) == known:
                break
        found.append(sorted(mine, key=lambda approach: approach.distance))
    return found


def least(
    poses: NDArray[np.float64], simulation: Simulation, robots: Sequence[int], ends: Sequence[int], world: int = 0
) -> list[Approach | None]:
    """For each of some objects the moment at which it was closest to anything, quickly; None without anything.

    Args:
        poses: (T, N, 3) as in :func:`clearance`.
        simulation: In the scene that they are of.
        robots: Whose, as indices.
        ends: For each how many rows count.
        world: Which of its worlds.
    """
    records = simulation.scenario.objects
    company = company_of(records)
    found = core.least_clearances(simulation.world, simulation.state, world, poses, robots, company, ends)
    return [
        None if partner < 0 else Approach(row, distance, records[partner].name, KINDS[company[partner]])
        for distance, partner, row in zip(*(column.tolist() for column in found), strict=True)
    ]
