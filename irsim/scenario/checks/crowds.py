"""Finds crowds whose members stop for good when they brush against each other."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from irsim.diagnostics.diagnostic import Edit
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, hint
from irsim.scenario.resolve.resolved import ObjectRecord

_CROWD = 6
"""Number of people with a way to one goal, as obstacles, from which some are likely to touch."""


def check(context: Context) -> Iterator[Finding]:
    """One finding: people who walk by forces, in a world where a contact stops both for good."""
    world = context.scenario.world
    if world.collision_mode != "stop":
        return
    pushed = [record for record in context.entry_objects if _is_pushed(record)]
    people = [record for record in pushed if record.wander or record.loop]
    if len(people) < 2:
        people = [record for record in pushed if record.role == "obstacle"]
        if len(people) < _CROWD:
            return
    mode = "unobstructed" if any(record.role == "robot" for record in people) else "unobstructed_obstacles"
    given = "collision_mode" in (context.data.get("world") or {})
    yield hint(
        "crowd-stops",
        ("world", "collision_mode") if given else people[0].path,
        f"'{people[0].name}' and {len(people) - 1} more walk by 'sfm', whose people touch now and then, and "
        "collision_mode: stop stops both for good: more and more of them stand still",
        given="stop" if given else None,
        fix=f"world.collision_mode: {mode}"
        + (" (robots stop as before)" if mode != "unobstructed" else "")
        + ", or behavior: {name: orca}",
        edit=Edit("replace" if given else "add", ("world", "collision_mode"), mode, safe=False),
    )


def _is_pushed(record: ObjectRecord) -> bool:
    """Whether an object walks by forces."""
    options: Any = record.active_behavior
    options = getattr(options, "local", options)
    if record.static or record.unobstructed or record.kinematics is None:
        return False
    return bool(getattr(options, "touches", False))
