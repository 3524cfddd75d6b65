"""Names of the kinds of events, for readers of results that have no engine."""

from __future__ import annotations

from typing import Literal

__all__ = ["BETWEEN_STEPS", "EVENTS", "SIGHTS", "EventKind"]

EventKind = Literal[
    "arrival",
    "waypoint",
    "collision",
    "no_path",
    "overshoot",
    "zone_entry",
    "zone_exit",
    "line_crossing",
    "sight_start",
    "sight_end",
    "contact_between_steps",
    "passed_through",
    "believed_arrival",
]
"""Kinds of events; :class:`irsim.simulation.events.Event` says what they mean."""
SIGHTS: tuple[EventKind, ...] = ("sight_start", "sight_end")
"""Kinds of events of fields of view."""
BETWEEN_STEPS: tuple[EventKind, ...] = ("contact_between_steps", "passed_through")
"""Kinds of contacts that begin and end within one step; a contact has one of them."""
EVENTS: dict[str, str] = {
    "arrival": "The last goal is reached.",
    "waypoint": "A goal is reached, and another one follows.",
    "collision": "A contact of two objects begins; it is reported once, not at every step. Its time is the end of the "
    "step, or the first touch with world.contacts: swept.",
    "no_path": "The behavior follow has found no path, or no path round the object partner, which stands for good.",
    "overshoot": "An object passed its goal within goal_threshold between two steps without arriving; reported once "
    "per goal.",
    "zone_entry": "The body of an object begins to touch a region of world.zones.",
    "zone_exit": "The body of an object ceases to touch a region of world.zones.",
    "line_crossing": "The centre of an object crosses a line of world.zones, in the direction that is given.",
    "sight_start": "An object comes into the field of view of another one.",
    "sight_end": "An object goes out of the field of view of another one.",
    "contact_between_steps": "Two objects that are apart at the beginning and at the end of a step touch within it. It "
    "has the time of the first touch and the depth of the deepest overlap, and counts as no collision: "
    "world.contacts: swept makes it one, a smaller world.step_time makes it rare. The metric contacts_between_steps "
    "counts them for each robot. The summary of a run names the first one, and pictures and pages mark it with a red "
    "diamond.",
    "passed_through": "Two objects that are apart at the beginning and at the end of a step touch within it, and the "
    "middle of one of them goes through the other, as a fast robot through a thin wall. It counts as no collision: "
    "world.contacts: swept makes it one, world.collision_mode: contact stops the robot at the wall, a smaller "
    "world.step_time makes it rare. Before a run, irsim validate warns of it with jumps-through. The metric "
    "contacts_between_steps counts it, too; pictures and pages mark it with a red diamond.",
    "believed_arrival": "A robot that perceives an estimate rests where it believes its last goal to be; the metric "
    "success_in_belief counts it. Whether it is there says arrival.",
}
"""Meaning of each kind of event."""
