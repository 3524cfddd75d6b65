"""The outcome of an episode, for each robot and for the team; success requires no collision before arrival."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from irsim.simulation.events import Event, first_collisions, first_events, read_events

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord
    from irsim.simulation.simulation import Simulation

__all__ = [
    "Outcome",
    "at_rest",
    "collided_robots",
    "explored_share",
    "is_over",
    "moves_by_itself",
    "outcome_of",
    "robot_outcomes",
]

Outcome = Literal["running", "success", "collision", "timeout"]


def collided_robots(simulation: Simulation, world: int = 0, events: list[Event] | None = None) -> set[str]:
    """Return the names of the robots that have collided so far, not counting collisions after their arrival.

    Args:
        simulation: The simulation.
        world: Index of the world.
        events: Events of the world, if they have already been read.
    """
    events = read_events(simulation, world) if events is None else events
    arrivals, collisions = first_events(events, "arrival"), first_collisions(simulation, events)
    robots = {record.name for record in simulation.scenario.objects if record.role == "robot"}
    return {
        name
        for name, hit in collisions.items()
        if name in robots and (name not in arrivals or hit.step <= arrivals[name].step)
    }


def robot_outcomes(simulation: Simulation, world: int = 0, events: list[Event] | None = None) -> dict[str, Outcome]:
    """Return the outcome of each robot so far.

    ``success``: the robot has arrived without a collision. ``collision``: the robot has arrived after a collision, or
    a collision has stopped it. ``running``: any other case, including a collision that did not stop the robot.

    Args:
        simulation: The simulation.
        world: Index of the world.
        events: Events of the world, if they have already been read.
    """
    events = read_events(simulation, world) if events is None else events
    arrivals, collided = first_events(events, "arrival"), collided_robots(simulation, world, events)
    outcomes: dict[str, Outcome] = {}
    for row, record in enumerate(simulation.scenario.objects, world * simulation.objects):
        if record.role != "robot":
            continue
        if record.name in arrivals:
            outcomes[record.name] = "collision" if record.name in collided else "success"
        else:
            stopped = record.name in collided and bool(simulation.stopped[row])
            outcomes[record.name] = "collision" if stopped else "running"
    return outcomes


def outcome_of(simulation: Simulation, world: int = 0, *, time_limit: float | None = None) -> Outcome:
    """Return the outcome of the team.

    Args:
        simulation: The simulation.
        world: Index of the world.
        time_limit: Time horizon [s]; default ``world.time_limit``.

    Returns:
        ``running`` until every robot has arrived or stopped, or the time limit is reached. After that, ``success`` if
        all robots have this outcome, ``collision`` if any robot has that one, and ``timeout`` otherwise.
    """
    limit = simulation.scenario.world.time_limit if time_limit is None else time_limit
    over = limit is not None and simulation.time >= limit - 1e-9
    if not (over or bool(simulation.done()[world])):
        return "running"
    outcomes = robot_outcomes(simulation, world).values()
    if outcomes and all(outcome == "success" for outcome in outcomes):
        return "success"
    return "collision" if "collision" in outcomes else "timeout"


def at_rest(simulation: Simulation) -> NDArray[np.uint8]:
    """(R,) whether each object has arrived or stopped; for one that goes by an estimate, whether it believes so."""
    estimating = [record.estimates for record in simulation.scenario.objects]
    arrived = simulation.arrived
    if any(estimating):
        arrived = np.where(np.tile(estimating, simulation.copies), simulation.state.believes_arrived, arrived)
    return arrived | simulation.stopped


def is_over(simulation: Simulation, world: int = 0) -> bool:
    """Whether every robot has arrived or stopped; without robots, whether everything else that moves has.

    Objects that wander or loop, or appear or vanish at a time, are never done; where nothing moves, it is over at once.
    """
    if simulation.robots.any():
        return bool(simulation.state.done(world))
    ended = at_rest(simulation)
    return all(
        ended[row] and not (record.wander or record.loop or record.vanish_time)
        for row, record in enumerate(simulation.scenario.objects, world * simulation.objects)
        if moves_by_itself(record)
    )


def moves_by_itself(record: ObjectRecord) -> bool:
    """Whether an object changes its place without being pushed: by its behavior, or as it appears or vanishes."""
    timed = bool(record.appear_time) or record.vanish_time is not None
    return timed or (not record.static and record.active_behavior is not None)


def explored_share(simulation: Simulation, world: int = 0) -> float | None:
    """Share of the cells of the fog that the robots have seen, from 0 to 1; None without ``fog_map``.

    The fog covers the whole world, so the insides of obstacles, which no robot sees, count in full.
    """
    cells = simulation.state.explored[world]
    return float(np.count_nonzero(cells)) / cells.size if cells.size else None
