"""The topics about kinds of events: one for each kind, and one that lists all."""

from __future__ import annotations

from irsim.common.event_kinds import BETWEEN_STEPS, EVENTS
from irsim.lookup.answer import Answer, Key

__all__ = ["event_answer", "events_answer"]

_SEE = {kind: ["world.contacts", "contacts_between_steps", "jumps-through", "outcomes"] for kind in BETWEEN_STEPS}
"""Topics that belong to some kinds."""


def event_answer(kind: str) -> Answer | None:
    """Describe a kind of event; None if there is none of that name."""
    for name, text in EVENTS.items():
        if name == kind:
            example = "irsim run scenario.yaml --json  # events have kind, time, step, object, partner, x, y"
            see = [*_SEE.get(name, ()), "events"]
            return Answer(topic=name, kind="event", title=f"event {name}", text=text, example=example, see=see)
    return None


def events_answer() -> Answer:
    """List the kinds of events."""
    lines = [Key(name=name, text=text) for name, text in EVENTS.items()]
    return Answer(topic="events", kind="index", title="Kinds of events", groups={"events": lines})
