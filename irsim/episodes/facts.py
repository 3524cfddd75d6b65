"""Facts about an episode after its last step, read from its events once, for its result and all its sentences."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from irsim.common.arrays import Floats
from irsim.episodes.between_steps import BetweenSteps, find_between_steps
from irsim.episodes.incidents import Incidents, find_incidents
from irsim.episodes.obstructions import find_jammed
from irsim.scenario.resolve.resolved import random_parts
from irsim.simulation.events import Event, passable_names
from irsim.simulation.outcome import explored_share
from irsim.simulation.roles import humans_of

if TYPE_CHECKING:
    from irsim.policies.policy import Policy
    from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario
    from irsim.simulation.simulation import Simulation

__all__ = ["EpisodeFacts", "first_collision"]

_MAX_POSES = 2_000_000
"""Number of poses, of all objects in all steps, up to which trajectories of all objects are searched."""


@dataclass(frozen=True)
class EpisodeFacts:
    """A simulation after its last step, and what its events say.

    Attributes:
        simulation: The simulation of one world.
        events: Its events.
        scenario: Its scenario.
        robots: Row -> record of each robot.
        hits: Collisions of robots; ``unobstructed`` objects do not collide.
        hit_counts: Number of these collisions of each robot, by its name.
        between: Contacts between steps.
        parked: Names of the robots that cannot move and have no goal of their own.
        jammed: Name of each moving obstacle that a collision has stopped -> that collision.
        humans: Records of the humans (:func:`irsim.simulation.roles.humans_of`).
        incidents: Incidents besides the outcomes of robots.
        steps: Number of executed steps.
        step_time: Period of a step [s].
        time: Simulated time [s].
        random: Names of the parts that the seed decides.
        explored: Share of the area of the world that the robots have seen; None without `fog_map`.
        is_small: Whether the trajectories of all objects can be searched.
        policy: The policy that drives the robots instead of their behaviors.
    """

    simulation: Simulation
    events: list[Event]
    scenario: ResolvedScenario
    robots: Mapping[int, ObjectRecord]
    hits: list[Event]
    hit_counts: Counter[str]
    between: BetweenSteps
    parked: list[str]
    jammed: dict[str, Event]
    humans: list[ObjectRecord]
    incidents: Incidents
    steps: int
    step_time: float
    time: float
    random: list[str]
    explored: float | None
    is_small: bool
    policy: Policy | None = None

    @classmethod
    def of(cls, simulation: Simulation, events: list[Event], policy: Policy | None = None) -> EpisodeFacts:
        """Find the facts of an episode.

        Args:
            simulation: The simulation after the last step.
            events: All its events.
            policy: The policy that drove the robots.
        """
        scenario, steps = simulation.scenario, int(simulation.count[0])
        robots = {row: record for row, record in enumerate(scenario.objects) if record.role == "robot"}
        names = {record.name for record in robots.values()}
        parked, random = (
            [record.name for record in robots.values() if scenario.is_parked(record)],
            random_parts(scenario),
        )
        passable, humans, explored = passable_names(simulation), humans_of(scenario.objects), explored_share(simulation)
        hits, counts = _collisions(events, names, passable)
        return cls(
            simulation=simulation,
            events=events,
            scenario=scenario,
            robots=robots,
            hits=hits,
            hit_counts=counts,
            between=find_between_steps(events, names, passable),
            parked=parked,
            jammed=find_jammed(simulation, events),
            humans=humans,
            incidents=find_incidents({record.name for record in humans}, events),
            steps=steps,
            step_time=scenario.world.step_time,
            time=steps * scenario.world.step_time,
            random=random,
            explored=explored,
            is_small=(steps + 1) * simulation.objects <= _MAX_POSES,
            policy=policy,
        )

    def track(self, row: int) -> Floats:
        """Positions and headings of an object at its start and after each step in which it moved, (K, 3)."""
        state = self.simulation.state
        return np.vstack([state.initial_state(row)[None, :3], state.trajectory(row)[:, :3]])


def _collisions(
    events: Sequence[Event], robots: Collection[str], passable: Collection[str]
) -> tuple[list[Event], Counter[str]]:
    """The collisions of robots, and their number for each robot."""
    hits, counts = list[Event](), Counter[str]()
    for event in events:
        if event.kind == "collision":  # cheapest test first: there may be a million events
            first, second = event.object, event.partner or ""
            mine, theirs = first in robots and second not in passable, second in robots and first not in passable
            if mine or theirs:
                hits.append(event)
            if mine:
                counts[first] += 1
            if theirs:
                counts[second] += 1
    return hits, counts


def first_collision(names: Collection[str], events: Sequence[Event]) -> Event | None:
    """The first collision of one of these objects; None if there was none."""
    return next((e for e in events if e.kind == "collision" and {e.object, str(e.partner)} & set(names)), None)
