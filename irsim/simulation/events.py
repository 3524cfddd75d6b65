"""Events that the core records during a step: arrivals, collisions, contacts between steps, zones, fields of view."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

from irsim.common.event_kinds import BETWEEN_STEPS, SIGHTS, EventKind

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = [
    "BETWEEN_STEPS",
    "SIGHTS",
    "Direction",
    "Event",
    "EventKind",
    "first_collisions",
    "first_events",
    "is_between_steps_of",
    "is_collision_of",
    "partner_of",
    "passable_names",
    "read_events",
]


Direction = Literal["left_to_right", "right_to_left"]
"""Direction in which a line is crossed, as seen from its first point towards its second."""
_CROSSINGS: dict[str, Direction] = {"crossing_to_right": "left_to_right", "crossing_to_left": "right_to_left"}
"""Names that the core gives the crossing of a line, by direction."""


class Event(NamedTuple):
    """An event of an episode.

    Zones and fields of view are looked at in the initial state and after every step. An object that starts in a region
    enters it at step 0, and one that starts in view is seen from step 0 on. The path of an object is the straight line
    from its position at one step to that at the next.

    Attributes:
        kind: ``arrival`` (the last goal is reached), ``waypoint`` (a goal is reached and another follows),
            ``collision`` (a contact of two objects begins; reported once per contact, not per step), ``no_path``
            (``follow`` finds no path, or no way round the object ``partner``, which stands for good), ``overshoot``
            (the object passed its goal within the threshold between two steps without arriving; reported once per
            goal), ``zone_entry`` and ``zone_exit`` (the body of an object that can move begins or ceases to touch a
            region of ``world.zones``), ``line_crossing`` (its centre crosses a line of ``world.zones``),
            ``sight_start`` and ``sight_end`` (another object comes into, or goes out of, the field of view that the
            scenario gives the object with ``fov``; of static obstacles only those with tags count),
            ``contact_between_steps`` (two objects that are apart at the beginning and at the end of a step touch
            within it), ``passed_through`` (likewise, and the middle of one of them went through the other, as a fast
            robot through a thin wall), ``believed_arrival`` (a robot that perceives an estimate rests where it believes
            its last goal to be; ``arrival`` says whether it is there).
        time: Simulated time [s]; of a contact between steps, and of a collision with ``world.contacts: swept``, when
            the two first touch within the step.
        step: Number of executed steps at the event, with the step of the event itself; 0 is the initial state.
        object: Name of the object; for a contact, of the first of the two objects; for a sight, of the one that sees.
        partner: Name of the second object of a contact, of the object that is seen, or round which there is no path.
        x, y: Position of the object, a point of the contact, the point at which the line is crossed, or the position
            of the object that is seen [m, world frame].
        zone: Name of the zone.
        direction: Direction in which the line is crossed, as seen from its first point towards its second.
        depth: Deepest overlap of the two within the step, of a contact between steps [m].
    """

    kind: EventKind
    time: float
    step: int
    object: str
    partner: str | None
    x: float
    y: float
    zone: str | None = None
    direction: Direction | None = None
    depth: float | None = None


def read_events(simulation: Simulation, world: int = 0, start: int = 0) -> list[Event]:
    """Return the events of one world since its last reset, in order of time.

    Args:
        simulation: The simulation.
        world: Index of the world.
        start: Number of earliest events to skip.
    """
    zones = simulation.scenario.world.zones
    step_time = float(simulation.scenario.world.step_time)
    events = []
    state = simulation.state
    rows = state.events(world, start)
    within = simulation.scenario.world.contacts == "swept" or any(row[0] in BETWEEN_STEPS for row in rows)
    moments = state.moments(world, start) if within else []
    for number, (kind, step, first, second, x, y) in enumerate(rows):
        when, depth = moments[number] if within else (1.0, 0.0)
        time = step * step_time if when == 1.0 else (step - 1 + when) * step_time
        name = simulation.names[first]
        if kind in _CROSSINGS:
            events.append(Event("line_crossing", time, step, name, None, x, y, zones[second].name, _CROSSINGS[kind]))
        elif kind in ("zone_entry", "zone_exit"):
            events.append(Event(kind, time, step, name, None, x, y, zones[second].name))  # type: ignore[arg-type]
        elif kind in BETWEEN_STEPS:
            events.append(Event(kind, time, step, name, simulation.names[second], x, y, depth=depth))
        else:
            partner = simulation.names[second] if second >= 0 else None
            events.append(Event(kind, time, step, name, partner, x, y))  # type: ignore[arg-type]
    return sorted(events, key=lambda event: event.time) if within else events


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
    return event.kind == "collision" and _is_contact_of(event, name, passable)


def is_between_steps_of(event: Event, name: str, passable: set[str]) -> bool:
    """Whether an event is a contact between steps of ``name`` with an object that is not in ``passable``."""
    return event.kind in BETWEEN_STEPS and _is_contact_of(event, name, passable)


def _is_contact_of(event: Event, name: str, passable: set[str]) -> bool:
    return name in (event.object, event.partner) and partner_of(event, name) not in passable


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
