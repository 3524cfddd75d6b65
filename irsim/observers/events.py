"""What happened, read from the step itself: arrivals, waypoints, collisions with partner, point and time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from irsim.simulation import Simulation

__all__ = ["Event", "first_events", "read_events"]


@dataclass(frozen=True, slots=True)
class Event:
    """One thing that happened.

    Attributes:
        kind: ``arrival`` (last goal reached), ``waypoint`` (a goal reached with more to come) or ``collision``
            (contact of two objects begins; reported once per contact, not per step).
        time: Simulated time [s].
        step: Steps executed when it was seen; 0 is the initial state.
        object: Name of the object; of the first of the two for a collision.
        partner: Name of the other object of a collision.
        x, y: Where [m, world frame]: position of the object, or a point of the contact.
    """

    kind: Literal["arrival", "waypoint", "collision"]
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
    records = simulation.scenario.objects
    step_time = simulation.scenario.world.step_time
    return [
        Event(kind, step * step_time, step, records[a].name, records[b].name if b >= 0 else None, x, y)  # type: ignore[arg-type]
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
