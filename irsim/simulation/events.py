"""Events that the core records during a step: arrivals, waypoints, and collisions with partner, point and time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = [
    "Event",
    "first_collisions",
    "first_events",
    "is_collision_of",
    "partner_of",
    "passable_names",
    "read_events",
]


class Event(NamedTuple):
    """An event of an episode.

    Attributes:
        kind: ``arrival`` (the last goal is reached), ``waypoint`` (a goal is reached and another follows),
            ``collision`` (a contact of two objects begins; reported once per contact, not per step), ``no_path``
            (``follow`` has found no path) or ``overshoot`` (the object passed its goal within the threshold between two
            steps without arriving; reported once per goal).
        time: Simulated time [s].
        step: Number of executed steps at the event; 0 is the initial state.
        object: Name of the object; for a collision, of the first of the two objects.
        partner: Name of the second object of a collision.
        x, y: Position of the object, or a point of the contact [m, world frame].
    """

    kind: Literal["arrival", "waypoint", "collision", "no_path", "overshoot"]
    time: float
    step: int
    object: str
    partner: str | None
    x: float
    y: float


def read_events(simulation: Simulation, world: int = 0, start: int = 0) -> list[Event]:
    """Return the events of one world since its last reset, in order of time.

    Args:
        simulation: The simulation.
        world: Index of the world.
        start: Number of earliest events to skip.
    """
    name = simulation.names
    step_time = simulation.scenario.world.step_time
    return [
        Event(kind, step * step_time, step, name[a], name[b] if b >= 0 else None, x, y)  # type: ignore[arg-type]
        for kind, step, a, b, x, y in simulation.state.events(world, start)
    ]


def first_events(events: list[Event], kind: str) -> dict[str, Event]:
    """Return the earliest event of a kind for each object that took part in one."""
    first: dict[str, Event] = {}
    for event in events:
        if event.kind == kind:
            first.setdefault(event.object, event)
            if event.partner is not None:
                first.setdefault(event.partner, event)
    return first


def partner_of(event: Event, name: str) -> str | None:
    """Return the name of the other object of an event."""
    return event.partner if event.object == name else event.object


def is_collision_of(event: Event, name: str, passable: set[str]) -> bool:
    """Whether an event is a collision of the object ``name`` with an object that is not in ``passable``."""
    has_contact = event.kind == "collision" and name in (event.object, event.partner)
    return has_contact and partner_of(event, name) not in passable


def passable_names(simulation: Simulation) -> set[str]:
    """Return the names of the objects that are ``unobstructed``, which means that others pass through them."""
    return {simulation.names[number] for number in simulation.passable}


def first_collisions(simulation: Simulation, events: list[Event]) -> dict[str, Event]:
    """Return the first collision of each object that had one."""
    passable = passable_names(simulation)
    first: dict[str, Event] = {}
    for event in events:
        if event.kind == "collision":
            for name in (event.object, event.partner):
                if name is not None and name not in first and is_collision_of(event, name, passable):
                    first[name] = event
    return first
