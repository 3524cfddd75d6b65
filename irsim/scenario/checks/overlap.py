"""Finds objects that start in collision."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import irsim._core as core
from irsim.common.text import metres
from irsim.diagnostics.diagnostic import Path
from irsim.options.vectors import is_vector
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, hint, warning
from irsim.scenario.model.scenario import Entry
from irsim.scenario.resolve.body_size import SizedBody, SizedShape, has_fixed_shape
from irsim.scenario.resolve.resolved import ObjectRecord

_MAX_REPORTED = 20
"""Findings for one scenario."""
_MAX_PAIRS = 300_000
"""Pairs that are examined; thousands of objects in one place have more, and are reported as stacked."""
_MAX_COUNTED = 10_000
"""Overlapping pairs of two entries that are counted."""
_DIRECTIONS = 16
"""Directions in which a free place or a way out is searched."""
_RINGS = 30
"""Circles round an object on which a free place is searched."""
FAR = (-1e8, -1e8, 1e8, 1e8)
"""Bounds of a terrain that nothing leaves [m]."""
_MIN_DEPTH = 1e-4
"""Smaller overlaps are invisible: the bodies touch [m]."""


def check(context: Context) -> Iterator[Finding]:
    """Report overlapping pairs with a robot or a moving object, and starts in unknown cells of the map.

    Objects placed at random are skipped, as are pairs whose other object is ``unobstructed``.
    """
    random = {index for placement in context.resolved.placements for index in placement.objects}
    shapes = dict[int, SizedShape]()
    bodies = [
        SizedBody(record, shapes.setdefault(id(record.shape), SizedShape(record.shape)))
        for record in context.resolved.objects
        if record.id not in random and has_fixed_shape(record.shape)
    ]
    reported = {path for path, entry, _ in context.entries() if _reports_stacking(entry)}
    overlaps: dict[tuple[Any, ...], tuple[ObjectRecord, ObjectRecord, int]] = {}
    for a, b in _near_pairs(bodies, reported):
        mover, other = (a.record, b.record) if _matters(a.record) else (b.record, a.record)
        if other.unobstructed or (mover.appear_time and not other.static) or other.appear_time:
            continue  # who appears later waits until there is room
        if mover.recorded and mover.role == "obstacle":
            continue  # nothing stops it
        key = (mover.path, other.path)
        if (len(overlaps) >= _MAX_REPORTED and key not in overlaps) or (
            key in overlaps and overlaps[key][2] >= _MAX_COUNTED
        ):
            continue
        if core.intersects(a.shape.parts, a.record.state[:3], b.shape.parts, b.record.state[:3]):
            first = overlaps.setdefault(key, (mover, other, 0))
            overlaps[key] = (*first[:2], first[2] + 1)
    by_id = {body.record.id: body for body in bodies}
    for mover, other, count in overlaps.values():
        where = context.entry_path(mover, "state") if context.is_given(mover, "state") else mover.path
        deep, place = _depth_text(by_id[mover.id], by_id[other.id]), _free_place(context, by_id[mover.id], bodies)
        instead = "" if place is None else f": ({place[0]:.2f}, {place[1]:.2f}) is free"
        harmless = context.scenario.world.collision_mode == "unobstructed" and not mover.appear_time
        yield (hint if harmless else warning)(
            "initial-overlap",
            where,
            f"'{mover.name}' {_meets(mover, harmless)} {other.called}{deep}"
            + (f", and {_count_of_others(count)} more such pairs of these entries" if count > 1 else ""),
            fix="move one of them, or make it smaller" + instead
            if other.path[0] != "world"
            else "start in free space" + instead,
        )
    yield from _check_unknown(context, bodies)


def _check_unknown(context: Context, bodies: list[SizedBody]) -> Iterator[Finding]:
    """Report what starts in unknown cells of the map, from where no planner finds a way."""
    terrain = [body for body in bodies if body.record.is_map]
    grid = context.resolved.grid
    if grid is None or not grid.unknown or not terrain:
        return
    cells = core.Terrain(FAR, [(terrain[0].shape.parts, [0.0, 0.0, 0.0])])
    known = set[Path]()
    for body in bodies:
        mover = body.record
        if not _matters(mover) or mover.is_terrain or len(known) >= _MAX_REPORTED:
            continue
        where = context.entry_path(mover, "state") if context.is_given(mover, "state") else mover.path
        if where in known:
            continue
        pose = mover.state[:3]
        if core.intersects(body.shape.parts, pose, terrain[0].shape.parts, [0.0, 0.0, 0.0]):
            continue  # reported as a collision
        if not cells.collides(body.shape.parts, pose):
            continue
        known.add(where)
        plans = getattr(mover.behavior, "name", None) == "follow"
        place = _free_place(context, body, bodies)
        yield (warning if plans else hint)(
            "initial-overlap",
            where,
            f"'{mover.name}' starts in an unknown part of the map, from where 'follow' finds no way",
            fix="start where the map is free"
            + ("" if place is None else f": ({place[0]:.2f}, {place[1]:.2f}) is free"),
        )


def _meets(mover: ObjectRecord, harmless: bool) -> str:
    if mover.appear_time:
        return "never appears, as its place is taken by"
    return f"starts {'overlapping' if harmless else 'in collision with'}"


def _count_of_others(count: int) -> str:
    return f"at least {count - 1}" if count >= _MAX_COUNTED else str(count - 1)


def _depth_text(a: SizedBody, b: SizedBody) -> str:
    """Depth of an overlap, in words, as a run measures it (``min_clearance``)."""
    x, y, heading = a.record.state[:3]
    depth = -core.distance(a.shape.parts, a.record.state[:3], b.shape.parts, b.record.state[:3])
    if depth >= _MIN_DEPTH:
        return f", {metres(depth)} deep"

    def meets(angle: float) -> bool:
        pose = (x + _MIN_DEPTH * math.cos(angle), y + _MIN_DEPTH * math.sin(angle), heading)
        return core.intersects(a.shape.parts, pose, b.shape.parts, b.record.state[:3])

    crossed = all(meets(2 * math.pi * k / _DIRECTIONS) for k in range(_DIRECTIONS))
    return "" if crossed else ": they touch"  # of outlines that cross no corner is inside


def _free_place(context: Context, mover: SizedBody, bodies: list[SizedBody]) -> tuple[float, float] | None:
    """The nearest position where a body, with its heading, overlaps no object of fixed position."""
    x, y, heading = mover.record.state[:3]
    step = max(mover.shape.reach / 4, 0.02)
    if not math.isfinite(step) or mover.record.is_terrain:
        return None
    rings = [step * k * (1 + k / 8) for k in range(1, _RINGS + 1)]
    around = mover.shape.reach + rings[-1]
    near = [
        (body.shape.parts, body.record.state[:3])
        for body in bodies
        if body is not mover
        and not body.record.unobstructed
        and math.hypot(body.record.state[0] - x, body.record.state[1] - y) <= around + body.shape.reach
    ]
    terrain = core.Terrain(context.scenario.world.bounds, near)
    for ring in rings:
        for k in range(_DIRECTIONS):
            angle = 2 * math.pi * k / _DIRECTIONS
            place = (x + ring * math.cos(angle), y + ring * math.sin(angle))
            if not terrain.collides(mover.shape.parts, (*place, heading)):
                return place
    return None


def _reports_stacking(entry: Entry) -> bool:
    """Whether the placement checks report overlaps within this entry."""
    return entry.distribution is not None or entry.state is None or is_vector(entry.state)


def _matters(record: ObjectRecord) -> bool:
    """Whether overlaps of an object are a mistake; static obstacles may overlap to form one wall."""
    return not record.static or record.role == "robot"


def _near_pairs(bodies: list[SizedBody], reported: set[Path]) -> Iterator[tuple[SizedBody, SizedBody]]:
    """Pairs with a robot or a moving object whose bounding circles meet, by a sweep along x.

    Args:
        bodies: Objects of fixed position.
        reported: Entries whose own objects are not paired with one another.
    """
    ordered = sorted(bodies, key=lambda body: body.record.state[0] - body.shape.reach)
    active: list[tuple[float, float, float, bool, Path, SizedBody]] = []
    looked_at = 0
    for body in ordered:
        x, y = body.record.state[:2]
        reach, matters, path = body.shape.reach, _matters(body.record), body.record.path
        active = [other for other in active if other[0] + other[2] >= x - reach]
        looked_at += len(active)
        if looked_at > _MAX_PAIRS:
            return
        own = path if path in reported else None
        for other_x, other_y, other_reach, other_matters, other_path, other in active:
            if not (matters or other_matters) or other_path == own:
                continue
            if math.hypot(other_x - x, other_y - y) <= reach + other_reach:
                yield other, body
        active.append((x, y, reach, matters, path, body))
