"""Objects that come into the world after its start, in words: who waited for room, who never came, who has left."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.text import listed, quoted, seconds
from irsim.simulation.build import steps_until

if TYPE_CHECKING:
    from irsim.env import Env
    from irsim.objects.view import ObjectView

__all__ = ["absence", "appearances_message", "is_absent"]

_MAX_NAMED = 3
"""Number of objects that a sentence names."""


def is_absent(env: Env, view: ObjectView) -> bool:
    """Return whether an object is not in the world yet, or not any more."""
    return bool(env.simulation.appeared[view.row] < 0)


def absence(env: Env, view: ObjectView) -> str:
    """Say why an absent object is not in the world: its time has not come or is over, or its place is taken."""
    if int(env.simulation.appeared[view.row]) < -1:
        return f"its recording ended at {seconds(view.record.vanish_time or 0.0)}"
    due = view.record.appear_time
    if int(env.simulation.count[0]) < steps_until(due, env.step_time):
        return f"it appears at {seconds(due)}"
    return f"since {seconds(due)} there has been no room for it at its start"


def appearances_message(env: Env) -> str | None:
    """Say which objects came later than their ``appear_time`` or not at all; None if all came in time."""
    late, missing = [], []
    for view in env.objects:
        due, appeared = view.record.appear_time, int(env.simulation.appeared[view.row])
        if not due or view.record.recorded:
            continue  # a recording waits for no room
        if appeared < 0:
            missing.append(f"{quoted(view.name)} did not appear ({absence(env, view)})")
        elif appeared > steps_until(due, env.step_time):
            waited = seconds(appeared * env.step_time - due)
            late.append(f"{quoted(view.name)} appeared {waited} late, when there was room at its start")
    found = [listed(names, _MAX_NAMED) for names in (late, missing) if names]
    return "; ".join(found) or None
