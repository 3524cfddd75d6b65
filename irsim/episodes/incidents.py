"""What happened in an episode besides the outcomes of robots: people who touched each other, goals jumped over."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

from irsim.common.text import metres, quoted, seconds
from irsim.scenario.resolve.resolved import ObjectRecord
from irsim.simulation.events import Event
from irsim.simulation.roles import HUMAN, kinds_of

__all__ = ["Incidents", "contacts_message", "find_incidents", "jumps_message", "returns_message"]


class Incidents(NamedTuple):
    """What happened in an episode besides outcomes.

    Attributes:
        human_contacts: Events of the contacts that began between two humans (:func:`irsim.simulation.roles.kinds_of`).
        jumps: Name of each object that jumped over a goal and has not reached one since -> its last event
            ``overshoot``, in order of time.
        returns: Name of each object that jumped over its last goal, came back and arrived -> these two events.
    """

    human_contacts: list[Event]
    jumps: dict[str, Event]
    returns: dict[str, tuple[Event, Event]]


def find_incidents(records: Sequence[ObjectRecord], events: Sequence[Event]) -> Incidents:
    """Find what happened besides outcomes.

    Args:
        records: Objects of the scenario.
        events: Events of the episode.
    """
    kinds = kinds_of(records)
    humans = {record.name for record, kind in zip(records, kinds, strict=True) if kind == HUMAN}
    found = Incidents([], {}, {})
    for event in events:
        if event.kind == "collision":
            if event.object in humans and event.partner in humans:
                found.human_contacts.append(event)
        elif event.kind in ("arrival", "waypoint", "overshoot"):
            jump = found.jumps.pop(event.object, None)
            if jump is not None and event.kind == "arrival":
                found.returns[event.object] = (jump, event)
            if event.kind == "overshoot":
                found.jumps[event.object] = event
    return found


def contacts_message(contacts: Sequence[Event], *, brief: bool) -> str | None:
    """How often people touched each other, and who did first; None if nobody did.

    Args:
        contacts: From :func:`find_human_contacts`.
        brief: Leave out the first one, which another message has.
    """
    if not contacts:
        return None
    first, many = contacts[0], len(contacts) > 1
    hit = f"{'first ' * many}{quoted(first.object)} hit {quoted(first.partner)} at {seconds(first.time)}"
    return f"{len(contacts)} contact{'s' * many} between people" + ("" if brief else f" ({hit})")


def jumps_message(jumps: dict[str, Event], nearest: Mapping[str, float]) -> str | None:
    """Which object jumped over its goal first, and what would let it arrive; None if none did.

    Args:
        jumps: From :func:`find_incidents`.
        nearest: Least distance [m] of each of these objects to its goal at any step from then on, as far as known.
    """
    if not jumps:
        return None
    first, others = next(iter(jumps.values())), len(jumps) - 1
    more = f" and {others} more after it" if others else ""
    near = nearest.get(first.object)
    close = "" if near is None else f", at no step nearer than {metres(near)}"
    return (
        f"{quoted(first.object)} jumped over its goal at {seconds(first.time)}{close}{more} "
        f"(raise goal_threshold{' above that' if close else ''} or lower step_time)"
    )


def returns_message(returns: Mapping[str, tuple[Event, Event]], robots: Collection[str]) -> str | None:
    """Which robot passed its goal between two steps, came back and arrived; None if none did.

    Args:
        returns: From :func:`find_incidents`.
        robots: Names of the robots.
    """
    mine = [(name, *events) for name, events in returns.items() if name in robots]
    if not mine:
        return None
    name, jump, arrival = mine[0]
    more = f" and {len(mine) - 1} more robots did so" if len(mine) > 2 else " and 1 more did so" * (len(mine) - 1)
    return (
        f"{quoted(name)} passed its goal between two steps at {seconds(jump.time)}, came back and arrived at "
        f"{seconds(arrival.time)}{more} (goal_threshold is small for its speed and step_time, or for its noise)"
    )
