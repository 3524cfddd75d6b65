"""What happened, read from the step itself: arrivals, waypoints, collisions with partner, point and time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Event", "collision_of", "first_collisions", "first_events", "partner_of", "passable_names", "read_events"]


class Event(NamedTuple):
    """One thing that happened.

    Attributes:
        kind: ``arrival`` (last goal reached), ``waypoint`` (a goal reached with more to come), ``collision`` (contact
            of two objects begins; reported once per contact, not per step) or ``no_path`` (``follow`` found none).
        time: Simulated time [s].
        step: Steps executed when it was seen; 0 is the initial state.
        object: Name of the object; of the first of the two for a collision.
        partner: Name of the other object of a collision.
        x, y: Where [m, world frame]: position of the object, or a point of the contact.
    """

    kind: Literal["arrival", "waypoint", "collision", "no_path"]
    time: float
    step: int
    object: str
    partner: str | None
    x: float
    y: float


def read_events(simulation: Simulation, world: int = 0, start: int = 0) -> list[Event]:
    """Events of one world since its last reset, in order.

    Args:
        simulation: Where to read.
        world: Index of the world.
        start: Leave out this many of the earliest.
    """
    name = simulation.names
    step_time = simulation.scenario.world.step_time
    return [
        Event(kind, step * step_time, step, name[a], name[b] if b >= 0 else None, x, y)  # type: ignore[arg-type]
        for kind, step, a, b, x, y in simulation.state.events(world, start)
    ]


def first_events(events: list[Event], kind: str) -> dict[str, Event]:
    """The earliest event of a kind for every object that took part in one."""
    first: dict[str, Event] = {}
    for event in events:
        if event.kind == kind:
            first.setdefault(event.object, event)
            if event.partner is not None:
                first.setdefault(event.partner, event)
    return first


def partner_of(event: Event, name: str) -> str | None:
    """The other one of the two objects of an event."""
    return event.partner if event.object == name else event.object


def collision_of(event: Event, name: str, passable: set[str]) -> bool:
    """Whether ``event`` is a collision of the object ``name``: it touched something that is not in ``passable``."""
    met = event.kind == "collision" and name in (event.object, event.partner)
    return met and partner_of(event, name) not in passable


def passable_names(simulation: Simulation) -> set[str]:
    """Names of the objects that are ``unobstructed``: others pass through them."""
    return {simulation.names[number] for number in simulation.passable}


def first_collisions(simulation: Simulation, events: list[Event]) -> dict[str, Event]:
    """The first collision of every object that had one."""
    passable = passable_names(simulation)
    first: dict[str, Event] = {}
    for event in events:
        if event.kind == "collision":
            for name in (event.object, event.partner):
                if name is not None and name not in first and collision_of(event, name, passable):
                    first[name] = event
    return first
