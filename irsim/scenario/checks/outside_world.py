"""Checks that objects start, and have their goals, inside the world."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from irsim.common.text import metres
from irsim.diagnostics.diagnostic import Path
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, hint
from irsim.scenario.model.scenario import Entry
from irsim.scenario.resolve.resolved import ObjectRecord, Placement
from irsim.scenario.yaml.formatting import flow

_MAX_BEYOND = 0.05
"""Share of its radius by which a round body may reach over the edge of the world at its goal without a hint."""


def check(context: Context) -> Iterator[Finding]:
    """Check each entry."""
    for path, entry, records in context.entries():
        if records and entry.distribution is not None and entry.distribution.name != "manual":
            yield from _placed_outside(context, path, entry, records)
        elif records:
            yield from _outside_world(context, records)


def _placed_outside(context: Context, path: Path, entry: Entry, records: list[ObjectRecord]) -> Iterator[Finding]:
    """Starts and goals that a distribution may place outside the world."""
    x0, y0, x1, y1 = context.scenario.world.bounds
    world, options = f"the world [{x0:g}, {x1:g}] × [{y0:g}, {y1:g}]", entry.distribution
    placement = next((p for p in context.resolved.placements if p.path == path), None)
    if placement is not None:
        yield from _drawn_outside(context, path, options, placement)
        return
    lost = [r for r in records if not (x0 <= r.state[0] <= x1 and y0 <= r.state[1] <= y1)]
    if not lost:
        return
    center = getattr(options, "center", None) or context.scenario.world.center
    room = min(center[0] - x0, x1 - center[0], center[1] - y0, y1 - center[1])
    fix = f"radius: {room:g} or less" if room > 0 else f"center: {flow(list(context.scenario.world.center))}"
    yield hint(
        "outside-world",
        (*path, "distribution"),
        f"{len(lost)} of {len(records)} objects start outside {world}, for example '{lost[0].name}' at "
        f"({lost[0].state[0]:.4g}, {lost[0].state[1]:.4g})",
        fix=fix if options.name == "circle" else "use places inside the world, or a larger world",
    )


def _outside_world(context: Context, records: list[ObjectRecord]) -> Iterator[Finding]:
    x0, y0, x1, y1 = context.scenario.world.bounds
    what = [("state", "starts")] if records[0].role == "robot" else []
    if any(not record.static for record in records) and records[0].role == "robot":
        what.append(("goal", "has a goal"))
    for key, words in what:
        for record in records:
            free = record.wander or (record.behavior is None and record.name in context.bridged)
            points = [record.state] if key == "state" else [] if free else record.goals
            lost = [(i, p) for i, p in enumerate(points) if not (x0 <= p[0] <= x1 and y0 <= p[1] <= y1)]
            if lost and (context.is_given(record, key) or key == "state" or record.behavior is not None):
                written = "waypoints" if key == "goal" and context.is_given(record, "waypoints") else key
                index, (x, y) = lost[0][0], lost[0][1][:2]
                yield hint(
                    "outside-world",
                    context.goal_path(record, written, index) if key == "goal" else context.entry_path(record, key),
                    f"'{record.name}' {words} at ({x:g}, {y:g}), outside the world "
                    f"[{x0:g}, {x1:g}] × [{y0:g}, {y1:g}]"
                    + ("" if context.is_given(record, written) else f" (the default {key})"),
                    fix=f"use x from {x0:g} to {x1:g} and y from {y0:g} to {y1:g}, or a larger world",
                )
                break
            near = key == "goal" and not free and context.is_given(record, "goal")
            over = _over_the_edge(context, record) if near else None
            if over is not None and not lost:
                yield over
                break


def _over_the_edge(context: Context, record: ObjectRecord) -> Finding | None:
    """A hint at the first goal where a round body reaches over an open edge of the world; walls are another matter."""
    if context.scenario.world.boundary == "walls" or record.shape.name != "circle" or record.wander:
        return None
    x0, y0, x1, y1 = context.scenario.world.bounds
    r = record.shape.radius
    for index, goal in enumerate(record.goals):
        x, y = goal[:2]
        beyond = r - min(x - x0, x1 - x, y - y0, y1 - y)
        if beyond > _MAX_BEYOND * r and x0 + r <= x1 - r and y0 + r <= y1 - r:
            return hint(
                "outside-world",
                context.goal_path(record, "goal", index),
                f"at its goal ({x:g}, {y:g}) the body of '{record.name}' reaches {metres(beyond)} over the edge of "
                "the world: nothing stops it there, and pictures show only a part of it",
                fix=f"use x from {x0 + r:g} to {x1 - r:g} and y from {y0 + r:g} to {y1 - r:g}, or a larger world",
            )
    return None


def _drawn_outside(context: Context, path: Path, options: Any, placement: Placement) -> Iterator[Finding]:
    """Bounds of random starts and goals that reach beyond the world."""
    x0, y0, x1, y1 = context.scenario.world.bounds
    world = f"the world [{x0:g}, {x1:g}] × [{y0:g}, {y1:g}]"
    for what, lows, highs in placement.ranges:
        (left, low), (right, high) = lows[:2], highs[:2]
        if left < x0 or low < y0 or right > x1 or high > y1:
            key = f"{what}_high" if right > x1 or high > y1 else f"{what}_low"
            written = getattr(options, key, None) is not None
            keys = {"circle_crossing": "'center' and 'radius'", "square_crossing": "'center' and 'width'"}
            removed = keys.get(placement.distribution, f"'{what}_low' and '{what}_high'")
            yield hint(
                "outside-world",
                (*path, "distribution", key) if written else (*path, "distribution"),
                f"random {'goals' if what == 'goal' else 'places'} have x from {left:g} to {right:g} and y from "
                f"{low:g} to {high:g}, partly outside {world}",
                fix=f"remove {removed}: the defaults end half a metre inside the world",
            )
