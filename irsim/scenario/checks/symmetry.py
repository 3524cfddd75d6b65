"""Checks for starts and goals that are so symmetric that behaviors which avoid others stop or follow each other."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from irsim.diagnostics.diagnostic import Edit
from irsim.scenario.checks._context import Context, distinct
from irsim.scenario.messages.findings import Finding, warning
from irsim.scenario.resolve.body_size import reach_of, top_speed
from irsim.scenario.resolve.resolved import ObjectRecord

_SIDESTEPPING = ("orca", "avocado", "rvo", "sfm")
"""Behaviors with the key ``sidestep``. By default they break ties between two that are each other's mirror images."""
_PASSING = ("rvo", "sfm")
"""Of these, behaviors that pass a slower object straight ahead all the same; `sfm` only where it breaks ties."""
_NOT_FOR_CARS = ("rvo", "sfm")
"""Of these, behaviors that choose velocities which a car cannot take up, whatever side they choose."""
_CROWDED = 4.0
"""Social forces wedge rings of bodies that are so wide, side by side, and stand on their circles for ever [m]."""
_ANGLE = 10.0
"""Angle that is proposed [degrees]."""
_OFF_LINE = 0.01
"""Ways less apart than this count as one line, and middles of ways as one point [m]."""
_MOST = 2000
"""Scenarios with more such objects are not checked."""


class _Way(NamedTuple):
    """The straight way of one object to its first goal: it moves from ``start`` to ``end`` on a line."""

    record: ObjectRecord
    start: float
    end: float


def check(context: Context) -> Iterator[Finding]:
    """Find objects on one line that move towards each other, or one behind a slower one; one finding per entry."""
    yield from distinct(_findings(context))


def _findings(context: Context) -> Iterator[Finding]:
    drawn = {row for placement in context.resolved.placements for row in placement.objects}
    records = [
        record
        for record in context.entry_objects
        if record.id not in drawn and record.goals and not record.wander and not record.unobstructed
        and record.spreads is None and 0 < top_speed(record) < math.inf and _needs_side(record)
    ]  # fmt: skip
    if not 1 < len(records) <= _MOST:
        return
    for ring in _rings(records):
        if not _meets_badly(ring[0], len(ring)):
            continue
        end = "touch or stand" if _pushes(ring[0]) else "brake, and may stand there for ever"
        what = f"meets {len(ring) - 1} others in the middle of their ways, all at the same time: they {end}"
        yield _finding(context, ring[0], what, _cure(ring[0], len(ring)))
    for ways in _lines(records):
        for a, b in itertools.pairwise(sorted(ways, key=lambda way: way.start)):
            if b.start == a.start:
                continue
            if a.end > a.start and b.end < b.start and a.end > b.end:
                if _meets_badly(a.record, 2):
                    what = f"meets '{b.record.name}' exactly head-on: {_effect(a.record)}"
                    yield _finding(context, a.record, what, _cure(a.record, 2))
                continue
            behind, ahead = (a, b) if a.end > a.start and b.end > b.start else (b, a)
            name = _options(behind.record).name
            passes = name in _PASSING and (name != "sfm" or not _keeps_ties(behind.record))
            if (a.end > a.start) == (b.end > b.start) and not passes and _catches_up(behind, ahead):
                end = "drives into" if _pushes(behind.record) else "trails"
                what = f"starts straight behind '{ahead.record.name}', which is slower: it {end} it instead of passing"
                yield _finding(context, behind.record, what, "sidestep")


def _needs_side(record: ObjectRecord) -> bool:
    options = _options(record)
    chooses = bool(getattr(options, "sidestep", None)) or getattr(options, "noise", 0.0) > 0.0
    return getattr(options, "name", "") in _SIDESTEPPING and not chooses


def _keeps_ties(record: ObjectRecord) -> bool:
    """Whether it leaves ties as they are, as in IR-SIM."""
    return getattr(_options(record), "sidestep", None) == 0


def _meets_badly(record: ObjectRecord, count: int) -> bool:
    """Whether so many that meet at one point brake for ever, or touch."""
    return _keeps_ties(record) or _needs_other(record, count)


def _needs_other(record: ObjectRecord, count: int) -> bool:
    """Whether so many robots pass one another only under another behavior."""
    crowded = _options(record).name == "sfm" and count > 2 and 2 * reach_of(record.shape) * count >= _CROWDED
    return crowded or _is_car(record)


def _is_car(record: ObjectRecord) -> bool:
    return _options(record).name in _NOT_FOR_CARS and getattr(record.kinematics, "steered", False)


def _cure(record: ObjectRecord, count: int) -> str:
    """Advice that lets so many objects pass: the default of ``sidestep``, or another behavior."""
    return "footprint_orca" if _needs_other(record, count) else "default"


def _options(record: ObjectRecord) -> Any:
    options = record.active_behavior
    return getattr(options, "local", options)


def _rings(records: Sequence[ObjectRecord]) -> Iterator[list[ObjectRecord]]:
    """Three or more objects whose straight ways have one middle, one length and one speed."""
    rings: dict[tuple[int, ...], list[ObjectRecord]] = defaultdict(list)
    for record in records:
        (x, y), goal = record.state[:2], record.goals[0]
        length = math.hypot(goal[0] - x, goal[1] - y)
        if 0 < length < math.inf:
            facts = ((x + goal[0]) / 2, (y + goal[1]) / 2, length, top_speed(record))
            rings[tuple(round(fact / _OFF_LINE) for fact in facts)].append(record)
    return (ring for ring in rings.values() if len(ring) > 2)


def _lines(records: Sequence[ObjectRecord]) -> Iterator[list[_Way]]:
    """Ways that lie on one line, together."""
    lines: dict[tuple[int, int], list[_Way]] = defaultdict(list)
    for record in records:
        (x, y), goal = record.state[:2], record.goals[0]
        dx, dy = goal[0] - x, goal[1] - y
        length = math.hypot(dx, dy)
        if not 0 < length < math.inf:
            continue
        angle = math.atan2(dy, dx) % math.pi
        if math.pi - angle < 1e-6:
            angle = 0.0
        along = (math.cos(angle), math.sin(angle))
        across = along[0] * y - along[1] * x
        start = along[0] * x + along[1] * y
        key = round(angle / _OFF_LINE), round(across / _OFF_LINE)
        lines[key].append(_Way(record, start, start + math.copysign(length, along[0] * dx + along[1] * dy)))
    return (ways for ways in lines.values() if len(ways) > 1)


def _catches_up(behind: _Way, ahead: _Way) -> bool:
    """Whether it would reach the one ahead, on the same line and in the same direction, before either goal."""
    fast, slow = top_speed(behind.record), top_speed(ahead.record)
    if fast <= slow:
        return False
    time = abs(ahead.start - behind.start) / (fast - slow)
    return time * fast < abs(behind.end - behind.start) and time * slow < abs(ahead.end - ahead.start)


def _pushes(record: ObjectRecord) -> bool:
    """Whether it moves by social forces alone: robots keep gaps by default, and ``follow`` has a way to keep apart."""
    options: Any = record.active_behavior
    if getattr(options, "name", "") != "sfm":
        return False
    return record.role != "robot" if options.keep_gap is None else not options.keep_gap


def _effect(record: ObjectRecord) -> str:
    if _pushes(record):
        return "social forces along one line only brake them, so they touch"
    return "both brake, and may stand there for ever"


def _finding(context: Context, record: ObjectRecord, what: str, cure: str) -> Finding:
    key = "behavior" if record.group_behavior is None else "group_behavior"
    path = context.entry_path(record, key)
    inner = "local" if hasattr(getattr(record, key), "local") else None
    where = (*path, inner) if inner else path
    name = _options(record).name
    key_path = (*where, "sidestep")
    if cure == "footprint_orca":
        other = "'follow' with 'local: {name: footprint_orca}'" if _is_car(record) and not inner else "'footprint_orca'"
        fix, edit = f"use {other} instead of {name}", None
    elif cure == "default":
        fix, edit = f"remove 'sidestep: 0' from {name}", Edit("remove", key_path, safe=False)
    else:
        fix = f"add 'sidestep: {_ANGLE:g}' to {name}, or move a start or a goal aside by its radius"
        edit = Edit("replace" if _keeps_ties(record) else "add", key_path, _ANGLE, safe=False)
    return warning("exact-symmetry", where if inner else path, f"'{record.name}' {what}", fix=fix, edit=edit)
