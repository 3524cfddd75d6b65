"""Names of the kinds of events, for those that read results without the engine."""

from __future__ import annotations

from typing import Literal

__all__ = ["BETWEEN_STEPS", "SIGHTS", "EventKind"]

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
]
"""Kinds of events; :class:`irsim.simulation.events.Event` says what they mean."""
SIGHTS: tuple[EventKind, ...] = ("sight_start", "sight_end")
"""Kinds of events of fields of view."""
BETWEEN_STEPS: tuple[EventKind, ...] = ("contact_between_steps", "passed_through")
"""Kinds of contacts that begin and end within one step; a contact has one of them."""
