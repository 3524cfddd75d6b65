"""Finds lengths and speeds that are too large to simulate or draw without loss of precision."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from irsim.diagnostics.diagnostic import Path
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, error
from irsim.scenario.resolve.body_size import reach_of

MAX_MAGNITUDE = 1e7
"""Largest length [m] and speed [m/s]."""


def check(context: Context) -> Iterator[Finding]:
    """Check the extent of the world, its zones, and the places, bodies and speeds of its objects."""
    world = context.scenario.world
    for key, values in (("width", [world.width]), ("height", [world.height]), ("offset", world.offset)):
        yield from _check_values(("world", key), values)
    for index, zone in enumerate(world.zones):
        places = [*(value for point in zone.points for value in point)]
        if zone.circle is not None:
            places += [*zone.circle.center, zone.circle.radius]
        yield from _check_values(("world", "zones", index), places)
    seen: set[Path] = set()
    for record in context.entry_objects:
        goals = [value for goal in record.goals for value in goal[:2]]
        key = "waypoints" if context.is_given(record, "waypoints") else "goal"
        limits = [value for value in (*record.vel_max, *record.vel_min) if math.isfinite(value)]
        bodies = [reach_of(record.shape)]
        for name, numbers in (("state", record.state[:2]), (key, goals), ("vel_max", limits), ("shape", bodies)):
            for finding in _check_values(context.entry_path(record, name), [v for v in numbers if math.isfinite(v)]):
                if finding.diagnostic.path not in seen:
                    seen.add(finding.diagnostic.path)
                    yield finding


def _check_values(path: Path, values: Iterable[float]) -> Iterator[Finding]:
    worst = max((abs(value) for value in values), default=0.0)
    if worst > MAX_MAGNITUDE:
        yield error(
            "too-large",
            path,
            f"lengths and speeds must be at most {MAX_MAGNITUDE:.0e} m or m/s, got {worst:.3g}",
            allowed=f"at most {MAX_MAGNITUDE:.0e}",
            fix="lengths are in metres",
        )
