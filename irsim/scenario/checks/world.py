"""Checks the world: periods that do not fit together, and sections that do not fit their entries."""

from __future__ import annotations

from collections.abc import Iterator

from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, error, hint, warning

_RATIO_TOLERANCE = 1e-6
"""Rounding error allowed in the ratio of two periods."""


def check(context: Context) -> Iterator[Finding]:
    """Checks sampling period, time limit and role keys."""
    world = context.scenario.world
    if world.sample_time is not None:
        ratio = world.sample_time / world.step_time
        if ratio < 1 - _RATIO_TOLERANCE:
            yield hint(
                "sample-time",
                ("world", "sample_time"),
                f"sample_time ({world.sample_time:g} s) is shorter than step_time ({world.step_time:g} s): every step "
                "is drawn",
                given=world.sample_time,
            )
        elif abs(ratio - round(ratio)) > _RATIO_TOLERANCE:
            yield hint(
                "sample-time",
                ("world", "sample_time"),
                f"sample_time ({world.sample_time:g} s) is not a multiple of step_time ({world.step_time:g} s): drawn "
                f"every {int(ratio) * world.step_time:g} s",
                given=world.sample_time,
            )
    if world.time_limit is not None and world.time_limit < world.step_time:
        yield warning(
            "time-limit",
            ("world", "time_limit"),
            f"time_limit ({world.time_limit:g} s) is shorter than one step ({world.step_time:g} s)",
            given=world.time_limit,
        )
    for path, entry, _ in context.entries():
        if entry.role is not None and entry.role != path[0]:
            yield error(
                "role-mismatch",
                (*path, "role"),
                f"role '{entry.role}' does not match the section '{path[0]}'",
                given=entry.role,
                allowed=[str(path[0])],
                fix=f"move the entry to '{entry.role}:', or remove the key",
            )
