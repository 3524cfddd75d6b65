"""Checks states and goals: nesting, ignored values, goals reached at once, headings of goals."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import Any

from irsim.common.text import metres
from irsim.components.options import CustomOptions
from irsim.diagnostics.diagnostic import Edit, Path
from irsim.options.vectors import is_vector
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, error, hint, warning
from irsim.scenario.messages.number_text import decimal_commas
from irsim.scenario.model.lookup import at
from irsim.scenario.model.scenario import Entry
from irsim.scenario.resolve.expand import DEFAULT_GOAL, DEFAULT_STATE, SPREAD_KEYS
from irsim.scenario.resolve.per_object import is_per_object, kind_of
from irsim.scenario.resolve.resolved import ObjectRecord
from irsim.scenario.yaml.formatting import flow

_MAX_HEADING = 6.3
"""Largest heading that is surely in radians: a full turn, rounded up [rad]."""
_MAX_THRESHOLD_RATIO = 0.5
"""Share of a rectangle's diagonal within which more than half of all pairs of its points lie."""


def check(context: Context) -> Iterator[Finding]:
    """Check each entry."""
    for path, entry, records in context.entries():
        yield from _goal_nesting(path, entry)
        if entry.goal is not None and entry.waypoints is not None:
            yield error(
                "conflicting-keys",
                (*path, "waypoints"),
                "'goal' and 'waypoints' exclude each other: both say where to go",
                fix="keep one of them",
            )
        if entry.distribution is not None and entry.distribution.name != "manual":
            yield from _ignored_keys(path, entry)
        elif records:
            yield from _state(context, path, entry, records)
        if records and (entry.distribution is None or entry.distribution.name == "manual"):
            yield from _surplus_states(path, entry)
            yield from _surplus_values(context, path, entry)
            yield from _default_goal(context, path, entry, records)
            yield from _headings_in_degrees(context, records)
        yield from _goals_reached_at_start(context, records)
        yield from _threshold_too_large(context, path, entry, records)
        yield from _heading_not_reached(context, path, records)


def _heading_not_reached(context: Context, path: Path, records: list[ObjectRecord]) -> Iterator[Finding]:
    """Arrival that requires a heading that the drive never turns to, or the behavior of a car never plans for."""
    for record in records:
        drive: Any = record.kinematics
        behavior: Any = record.behavior or record.group_behavior
        headings = [goal[2] for goal in record.goals if len(goal) > 2]
        if record.arrive_mode != "state" or not headings or drive is None or drive.speeds == 0 or record.static:
            continue
        if isinstance(behavior, CustomOptions | None):
            continue
        if not drive.turns:
            off = max(abs(math.remainder(heading - record.state[2], 2 * math.pi)) for heading in headings)
            if off < record.goal_threshold:
                continue
            message = (
                f"'{record.name}' keeps its heading and never turns to the goal's heading, which is {off:.3g} rad off"
            )
            fix = "kinematics: {name: omni_angular}, or {name: diff}"
        elif drive.steered and behavior.name != "follow":
            message = (
                f"'{record.name}' is a car, and '{behavior.name}' steers it to the position of its goal only: it comes "
                "there with any heading"
            )
            fix = f"behavior: {{name: follow, local: {behavior.name}}}, which plans a car to the heading, too"
        else:
            continue
        yield warning(
            "heading-not-reached",
            (*path, "arrive_mode"),
            message,
            given="state",
            fix=f"{fix}; a goal of two numbers; or arrive_mode: position",
        )
        return


def _goals_reached_at_start(context: Context, records: list[ObjectRecord]) -> Iterator[Finding]:
    """Goals that count as reached at the start, and waypoints that count as reached together."""
    for record in records:
        if record.static or record.wander or record.loop or not record.goals or record.kinematics is None:
            continue
        if record.recorded:
            continue  # a replayed object may legitimately stay at its goal
        points = [record.state, *record.goals]
        for index, (a, b) in enumerate(itertools.pairwise(points)):
            if not _arrives(record, a, b):
                continue
            key = "waypoints" if context.is_given(record, "waypoints") else "goal"
            where = context.goal_path(record, key, index) if context.is_given(record, key) else record.path
            gap = f"{metres(math.dist(a[:2], b[:2]))}"
            if index == 0:
                what = "goal" if len(record.goals) == 1 else "first goal"
                message = f"'{record.name}' starts {gap} from its {what}: within {record.goal_threshold:g} m it counts"
                message += " as reached"
            else:
                message = f"waypoint {index + 1} of '{record.name}' is {gap} from the one before: both count as "
                message += "reached at once"
            yield warning(
                "goal-reached",
                where,
                message,
                fix=f"use a place farther away, or a smaller goal_threshold (now {record.goal_threshold:g} m)",
            )
            break


def _threshold_too_large(context: Context, path: Path, entry: Entry, records: list[ObjectRecord]) -> Iterator[Finding]:
    """A goal threshold as large as the area in which goals are drawn."""
    placement = next((p for p in context.resolved.placements if p.path == path), None)
    for record in records:
        if record.static or record.kinematics is None or record.arrive_mode == "state":
            continue
        if record.wander:
            low, high = record.range_low, record.range_high
        elif placement is not None:
            _, low, high = placement.ranges[-1]
        else:
            continue
        width, height = high[0] - low[0], high[1] - low[1]
        diagonal = math.hypot(width, height)
        if diagonal == 0 or record.goal_threshold < _MAX_THRESHOLD_RATIO * diagonal:
            continue
        sure = record.goal_threshold >= diagonal
        yield warning(
            "goal-reached",
            (*path, "goal_threshold") if "goal_threshold" in entry.model_fields_set else path,
            f"goals are drawn within {width:g} m × {height:g} m and count as reached within "
            f"{record.goal_threshold:g} m: {'all' if sure else 'most'} are reached before any object has moved",
            given=record.goal_threshold,
            fix=f"goal_threshold: {min(0.3, diagonal / 20):.2g}; lengths are in metres",
        )
        return


def _arrives(record: ObjectRecord, a: list[float], b: list[float]) -> bool:
    """Whether an object in state a has reached goal b."""
    turn = 0.0
    if record.arrive_mode == "state" and len(b) > 2:
        turn = math.remainder((a[2] if len(a) > 2 else 0.0) - b[2], 2 * math.pi)
    return math.hypot(a[0] - b[0], a[1] - b[1], turn) < record.goal_threshold


def _goal_nesting(path: Path, entry: Entry) -> Iterator[Finding]:
    goal: Any = entry.goal
    if goal is None or is_vector(goal) or len(goal) <= max(entry.number, 1):
        return
    if not all(is_vector(item) for item in goal):
        return
    state: Any = entry.state
    if isinstance(state, list) and not is_vector(state) and len(state) == len(goal):
        return  # states and goals belong together; 'number' uses the first of both
    if entry.number > 1:  # as waypoints they would be the same for all objects
        yield warning(
            "goal-levels",
            (*path, "goal"),
            f"{len(goal)} goals, one per object, but the entry makes {entry.number}: only the first {entry.number} are "
            "used",
            given=goal,
            fix=f"goal: {flow(goal[: entry.number])}, or number: {len(goal)}; for several goals per object write "
            "one entry per object, each with its 'waypoints'",
            edit=Edit("replace", (*path, "goal"), goal[: entry.number], safe=False),
        )
        return
    yield warning(
        "goal-levels",
        (*path, "goal"),
        f"a list of {len(goal)} goals is one goal per object: only the first is used",
        given=goal,
        fix="write 'waypoints:' instead of 'goal:' to visit them one after the other",
        edit=Edit("rename", (*path, "goal"), "waypoints"),
    )


def _ignored_keys(path: Path, entry: Entry) -> Iterator[Finding]:
    name = entry.distribution.name
    keys = ["state"] if name == "circle" else ["state", "goal", "waypoints"]
    for key in keys:
        goes = key != "state"
        if getattr(entry, key) is not None:
            yield warning(
                "ignored-key",
                (*path, key),
                f"the distribution '{name}' places the objects: '{key}' has no effect",
                fix=f"remove '{key}', or use the distribution 'manual'"
                + (
                    "; goal_low and goal_high of the distribution say where goals are"
                    if goes and name == "random"
                    else ""
                ),
                edit=Edit("remove", (*path, key)),
            )


def _state(context: Context, path: Path, entry: Entry, records: list[ObjectRecord]) -> Iterator[Finding]:
    if entry.state is None and not records[0].recorded:
        shape: Any = records[0].shape
        if shape.name in ("polygon", "linestring") and shape.vertices is not None and not shape.random_shape:
            yield warning(
                "default-state",
                (*path, "shape"),
                "without 'state' the object is at [1, 1, 0], which shifts its vertices by (1, 1)",
                fix="add 'state: [0, 0, 0]' if the vertices are world coordinates",
                edit=Edit("add", (*path, "state"), [0, 0, 0], safe=False),
            )
        elif len(records) == 1 and not getattr(shape, "random_shape", False):
            yield hint(
                "default-state",
                path,
                f"without 'state' the object starts at {flow(DEFAULT_STATE)}",
                fix="add 'state: [x, y, theta]'",
                edit=Edit("add", (*path, "state"), DEFAULT_STATE),
            )
    elif entry.state is not None and records[0].role == "robot":
        states: Any = [entry.state] if is_vector(entry.state) else entry.state
        longest = max((len(state) for state in states[: entry.number] if state is not None), default=0)
        if longest > (rows := records[0].state_dim):
            written = at(context.data, (*path, "state"))
            text = context.document.source_text((*context.document.prefix, *path, "state"))
            meant = decimal_commas(written, rows, text) if is_vector(written) and any(written[rows:]) else None
            yield (hint if meant is None else warning)(
                "state-truncated",
                (*path, "state"),
                f"'state' must have at most {rows} numbers, got {longest}: the rest is ignored",
                fix=None if meant is None else f"decimal commas? write {meant}",
            )


def _default_goal(context: Context, path: Path, entry: Entry, records: list[ObjectRecord]) -> Iterator[Finding]:
    driven = [
        r
        for r in records
        if not r.static
        and not r.wander
        and r.active_behavior is not None
        and getattr(r.active_behavior, "needs_goal", True)
        and r.name not in context.bridged  # of which driven-without-goal tells
    ]
    if driven and entry.goal is None and entry.waypoints is None:
        yield hint(
            "default-goal",
            path,
            f"without 'goal' the object drives to {flow(DEFAULT_GOAL)}",
            fix="add 'goal: [x, y]', or 'wander: true' to the behavior",
            edit=Edit("add", (*path, "goal"), DEFAULT_GOAL),
        )


def _headings_in_degrees(context: Context, records: list[ObjectRecord]) -> Iterator[Finding]:
    """Headings above a full turn that are whole numbers, so they may be degrees."""
    for key in ("state", "goal", "waypoints"):
        for record in records:
            if not context.is_given(record, key):
                break
            poses = [record.state] if key == "state" else record.goals
            turned = (i for i, pose in enumerate(poses) if len(pose) > 2 and abs(pose[2]) > _MAX_HEADING)
            if (index := next(turned, None)) is None:
                continue
            angle = poses[index][2]
            if angle == int(angle):
                yield hint(
                    "heading-in-degrees",
                    context.entry_path(record, key) if key == "state" else context.goal_path(record, key, index),
                    f"a heading of {angle:g} radians is {abs(angle) / (2 * math.pi):.1f} turns",
                    fix=f"angles are in radians: {angle:g} degrees are {math.radians(angle):.5g}",
                )
                break


def _surplus_states(path: Path, entry: Entry) -> Iterator[Finding]:
    """States for more objects than the entry makes."""
    state: Any = entry.state
    count = len(state) if isinstance(state, list) and not is_vector(state) else 0
    if count <= entry.number or entry.number == 0:
        return
    written = "number" in entry.model_fields_set
    makes = "1 object" if entry.number == 1 else f"{entry.number} objects"
    yield (hint if written else warning)(
        "surplus-states",
        (*path, "state"),
        f"{count} states, but the entry makes {makes}"
        + ("" if written else ", because it has no 'number'")
        + ": the other states are ignored",
        fix=f"number: {count}",
        edit=Edit("replace" if written else "add", (*path, "number"), count, safe=False),
    )


def _surplus_values(context: Context, path: Path, entry: Entry) -> Iterator[Finding]:
    """Values of other keys for more objects than the entry makes, unless there are surplus states to report."""
    written: Any = at(context.data, path)
    counts = {
        key: len(written[key])
        for key in SPREAD_KEYS
        if key not in ("state", "goal") and key in written and is_per_object(written[key], kind_of(key))
    }
    states = written.get("state")
    given = len(states) if isinstance(states, (list, tuple)) and not is_vector(states) else 0
    for key, count in counts.items():
        if not 0 < entry.number < count or given >= count:
            continue
        makes = "1 object" if entry.number == 1 else f"{entry.number} objects"
        kind = warning if key == "name" or "number" not in entry.model_fields_set else hint
        yield kind(
            "surplus-states",
            (*path, key),
            f"{count} values, but the entry makes {makes}: the rest is ignored",
            given=written[key],
            fix=f"number: {count}, or one value per object",
        )
