"""Tables of a recorded run: positions step by step, collisions, closest approaches, speeds, zones, sights."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from irsim.common.arrays import Floats
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import suggestion
from irsim.metrics import approaches
from irsim.results.run import RunTable
from irsim.runs.files import RunError
from irsim.runs.reading import Run, open_run
from irsim.runs.readings import NOT_RECORDED, reading_cell, reading_columns
from irsim.runs.resimulation import scenario_of
from irsim.runs.tables import (
    Cell,
    Field,
    Question,
    Table,
    chosen_objects,
    paged,
    rounded,
    sight_empty_message,
    sight_view,
    zone_view,
    zones_empty_message,
)
from irsim.scenario.limits import Limits
from irsim.simulation.events import BETWEEN_STEPS
from irsim.simulation.trace import Trace

__all__ = ["FIELDS", "VIEWS", "Field", "View", "inspect_run"]

View = Literal["rows", "collisions", "closest", "speeds", "zones", "sight"]
FIELDS: tuple[Field, ...] = get_args(Field)
_SHOWN: tuple[Field, ...] = ("x", "y", "heading", "speed", "goal_distance", "status")
_MIN_SPEED = 1e-3
"""Speed [m/s] below which an object stands still."""
_CONTACTS = ("collision", *BETWEEN_STEPS)
"""Kinds of events of the view ``collisions``."""
_MIN_STEERED_SPEED = 0.01
"""Speed [m/s] from which on the path of a car tells its steering angle."""
_MAX_PARTNERS = 5
"""Number of objects of each kind that ``closest`` lists for one object."""


def inspect_run(
    run: str | Path | Run,
    *,
    view: str = "rows",
    robot: str | None = None,
    from_step: int = 0,
    to_step: int | None = None,
    every: int | None = None,
    fields: Sequence[str] | None = None,
    limit: int | None = 20,
    cursor: str | None = None,
    workspace: str | Path | None = None,
    limits: Limits | None = None,
) -> RunTable:
    """A part of a recorded run as a table.

    Args:
        run: Id of the run, its folder, or ``last``.
        view: ``rows``: positions and more, step by step; ``collisions``: contacts, with place and speeds; if they begin
            and end within one step (``contact_between_steps``, ``passed_through``) also with the deepest overlap;
            ``closest``: the closest approaches of each robot to the nearest five robots, humans and static objects,
            with time and place, as distances between footprints at the ends of steps (negative: overlap);
            ``speeds``: path length and speeds of each robot and its longest stop, until it arrived (or of all requested
            steps if they begin after its arrival). ``speed`` is a magnitude, never negative;
            ``min_forward_speed`` is the velocity along the heading, negative where the robot drove backwards (None for
            omnidirectional drives); ``max_turn_rate`` and ``max_steering`` (angle of a car's wheels [rad]) are
            magnitudes, too. ``zones``: who was in a region of ``world.zones`` from when to when, and who crossed a
            line in which direction; ``sight``: who saw whom from when to when.
        robot: Name of one robot, or of another object; ``all`` (all objects that can move), ``robots``, ``obstacles``
            (that can move), a tag, or several of these, separated by commas; default: all robots, in ``zones``
            and ``sight`` all objects.
        from_step: First step.
        to_step: Last step; default: the last step of the run.
        every: Take every Nth step; default: the smallest N with which the table fits into ``limit``.
        fields: Columns of ``rows``, see :data:`FIELDS`; ``readings``: what sensors without beams report; or one number
            of a sensor, such as ``odometry.x`` or ``imu.yaw_rate``.
        limit: Greatest number of rows of the table, None for all.
        cursor: ``next_cursor`` of the previous page; all other arguments as in that call.
        workspace: Folder whose ``.irsim/runs`` holds the run; default: the current directory.
        limits: Limits of the reader of the scenario, which ``closest`` needs.

    Raises:
        RunError: There is no such run, robot, step or field.
    """
    opened = run if isinstance(run, Run) else open_run(run, workspace)
    trace = opened.trace()
    begin, end = int(trace.step[0]), int(trace.step[-1])
    last = end if to_step is None else min(to_step, end)
    if from_step > end or last < from_step:
        to = "on" if to_step is None else f"to {to_step}"
        what = f"run {opened.id} has no steps from {from_step} {to}"
        raise RunError("step-out-of-range", what, opened.extent, where="from_step" if from_step > end else "to_step")
    objects, named = chosen_objects(opened, robot)
    chosen = _fields(fields, reading_columns(trace, objects))
    start = _start(cursor)
    question = Question(
        opened, trace, objects, named, from_step - begin, last - begin, every, chosen, start, limit, limits
    )
    table = VIEWS[view](question)
    if start and start >= table.total:
        what = f"cursor {cursor!r} is beyond the last row"
        raise RunError("bad-argument", what, "use next_cursor of the previous page", where="cursor")
    shown = start + len(table.rows)
    result = opened.result
    return RunTable(
        run_id=opened.id,
        status=opened.status,
        outcome=None if result is None else result.outcome,
        lost=None if result is None else result.lost,
        summary=f"recorded until step {end}" if result is None else result.summary,
        view=view,
        columns=table.columns,
        rows=table.rows,
        total=table.total,
        every=table.every,
        from_step=from_step,
        to_step=last,
        next_cursor=str(shown) if shown < table.total else None,
        notes=[*opened.notes, *_beyond(opened, end, to_step), *_empty(question, view, table)],
    )


def _beyond(run: Run, end: int, to_step: int | None) -> list[str]:
    """A note if steps were asked for that come after the end of a run."""
    if to_step is None or to_step <= end:
        return []
    return [f"step {to_step} is beyond the end of the episode: {run.extent}"]


def _empty(question: Question, view: str, table: Table) -> list[str]:
    """A note that says why a table has no rows."""
    message = _EMPTY_MESSAGES.get(view)
    return [] if table.total or message is None else [message(question)]


# request --------------------------------------------------------------------------------------------------------------


def _fields(names: Sequence[str] | None, readings: Sequence[str]) -> Sequence[str]:
    """The columns of the view ``rows``.

    Args:
        names: Names as given.
        readings: Numbers of sensors of the chosen objects.
    """
    if names is None:
        return _SHOWN
    known = [*FIELDS, *readings]
    for index, name in enumerate(names):
        if name not in known:
            fix = suggestion(name, known, f"the fields are {', '.join(known)}")
            raise RunError("bad-argument", f"{clean(name)!r} is not a valid field", fix, where=f"fields[{index}]")
    told = [name for name in readings if "readings" in names or name in names]
    return [*(field for field in FIELDS if field in names and field != "readings"), *told]


def _start(cursor: str | None) -> int:
    if cursor is None:
        return 0
    if not (cursor.isascii() and cursor.isdigit() and len(cursor) < 12):
        fix = "use next_cursor of the previous page"
        raise RunError("bad-argument", f"{clean(cursor)!r} is not a valid cursor", fix, where="cursor")
    return int(cursor)


# views ----------------------------------------------------------------------------------------------------------------


def _rows(asked: Question) -> Table:
    """Rows of the trace, step by step, in each step robot by robot."""
    steps, count = asked.last - asked.first + 1, len(asked.objects)
    every = asked.every
    if every is None:  # spread evenly, including the last step
        fitting = steps if asked.limit is None else max(2, asked.limit // max(1, count))
        every = 1 if steps <= fitting else math.ceil((steps - 1) / (fitting - 1))
    picked = np.arange(asked.first, asked.last + 1, every)
    if asked.every is None and picked[-1] < asked.last:
        picked = np.append(picked, asked.last)
    total = len(picked) * count
    stop = total if asked.limit is None else min(total, asked.start + asked.limit)
    controls = _controls(asked)
    names = {"control": tuple(f"control_{number}" for number in range(controls)), "goal": ("goal_x", "goal_y")}
    columns = [name for field in asked.fields for name in names.get(field, (field,))]
    rows: list[list[Cell]] = []
    for number in range(asked.start, stop):
        row, index = int(picked[number // count]), asked.objects[number % count]
        cells = [cell for field in asked.fields for cell in _cells(asked, field, row, index, controls)]
        rows.append([int(asked.trace.step[row]), rounded(asked.trace.time[row]), asked.trace.names[index], *cells])
    return Table(["step", "time", "robot", *columns], rows, total, every)


def _controls(asked: Question) -> int:
    """Greatest number of control values of the chosen objects."""
    objects = asked.run.resolved["objects"]
    chosen = [objects[index].get("vel_dim") for index in asked.objects if objects[index].get("kinematics") is not None]
    return max((count for count in chosen if isinstance(count, int) and 0 < count <= 3), default=2)


def _cells(asked: Question, field: str, row: int, index: int, controls: int) -> list[Cell]:
    if "." in field:
        return [reading_cell(asked.trace, field, row, index)]
    trace, no_goal = asked.trace, not asked.run.resolved["objects"][index].get("goals")
    x, y, heading = trace.pose[row, index].tolist()
    goal_x, goal_y, _ = trace.goal[row, index].tolist()
    if field == "control":
        return [rounded(value) for value in trace.control[row, index, :controls]]
    if field == "goal":
        return [None, None] if no_goal else [rounded(goal_x), rounded(goal_y)]
    if field == "status":
        if math.isnan(x):
            return ["absent"]
        flags = (("arrived", trace.arrived), ("collided", trace.collided), ("stopped", trace.stopped))
        return [" ".join(word for word, flag in flags if flag[row, index]) or ("" if no_goal else "under way")]
    if field == "nearest_hit":
        prefix = f"{trace.names[index]}/"
        blocks = [block for key, block in trace.ranges.items() if key.startswith(prefix)]
        if any(row >= len(block) for block in blocks):
            return [NOT_RECORDED]
        least = [float(block[row].min()) for block in blocks if block.size]
        return [rounded(min(least, default=math.inf))]
    if field == "speed":
        return [rounded(float(_speeds(trace, index, row, row)[0]))]
    if field == "turn_rate":
        return [rounded(_turn_rate(trace, index, row))]
    value = {
        "x": x,
        "y": y,
        "heading": heading,
        "goal_distance": math.nan if no_goal else math.hypot(goal_x - x, goal_y - y),
    }[field]
    return [rounded(value)]


def _collisions(asked: Question) -> Table:
    """Beginnings of contacts, also of those within a step, with the speeds of both objects just before."""
    trace = asked.trace
    steps = asked.steps
    chosen = {trace.names[index] for index in asked.objects}
    events = [
        event
        for event in asked.run.events
        if event.kind in _CONTACTS and steps[0] <= event.step <= steps[1] and chosen & {event.object, event.partner}
    ]
    rows: list[list[Cell]] = []
    for event in events:
        row = event.step - int(trace.step[0])
        before = [_speed_before(trace, name, row) for name in (event.object, event.partner)]
        place = [rounded(event.x), rounded(event.y)]
        depth = None if event.depth is None else rounded(event.depth)
        moment: list[Cell] = [event.step, rounded(event.time), event.object, event.partner]
        rows.append([*moment, *place, *before, event.kind, depth])
    columns = ["step", "time", "object", "partner", "x", "y", "speed", "partner_speed", "kind", "depth"]
    return paged(asked, columns, rows)


def _closest(asked: Question) -> Table:
    """Closest approaches of each robot to other objects, the closest first."""
    scenario = scenario_of(asked.run, asked.limits)
    part, trace = asked.trace.pose[asked.first : asked.last + 1], asked.trace
    near = approaches(part, scenario, asked.objects, _MAX_PARTNERS, seed=int(asked.run.meta["seed"]))
    pairs = [(each, index) for index, some in zip(asked.objects, near, strict=True) for each in some]
    rows: list[list[Cell]] = []
    for each, index in sorted(pairs, key=lambda item: (item[0].distance, item[1])):
        row = asked.first + each.row
        moment: list[Cell] = [int(trace.step[row]), rounded(trace.time[row])]
        place: list[Cell] = [rounded(value) for value in trace.pose[row, index, :2]]
        speed = rounded(float(_speeds(trace, index, row, row)[0]))
        rows.append([trace.names[index], _precise(each.distance), each.partner, each.kind, *moment, *place, speed])
    return paged(asked, ["robot", "edge_distance", "to", "kind", "step", "time", "x", "y", "speed"], rows)


def _speeds_of_robots(asked: Question) -> Table:
    """Path length and speeds of each robot until it arrived, and its longest stop."""
    trace, rows = asked.trace, list[list[Cell]]()
    for index in asked.objects:
        arrived = trace.arrived[asked.first : asked.last + 1, index]
        first = int(np.argmax(arrived)) if arrived.any() else len(arrived)
        last = asked.first + first if 0 < first < len(arrived) else asked.last
        speeds = _speeds(trace, index, asked.first, last)
        begin, length = _longest_stop(speeds[:first])
        speeds = np.nan_to_num(speeds)  # before its appear_time it has no position
        way = float(speeds[1:].sum() * trace.step_time) if len(speeds) > 1 else 0.0
        stand: list[Cell] = [rounded(length * trace.step_time), None]
        if length:
            stand[1] = int(trace.step[asked.first + begin])
        mean = way / (max(1, len(speeds) - 1) * trace.step_time)
        fast: list[Cell] = [rounded(mean), rounded(float(speeds.max()))]
        turning = max((abs(_turn_rate(trace, index, row)) for row in range(asked.first, last + 1)), default=0.0)
        extremes: list[Cell] = [
            _least_forward(asked, index, last),
            rounded(turning),
            _most_steering(asked, index, last),
        ]
        rows.append([trace.names[index], rounded(way), *fast, *extremes, *stand, bool(arrived.any())])
    columns = [
        *("robot", "path_length", "mean_speed", "max_speed", "min_forward_speed", "max_turn_rate", "max_steering"),
        *("stood", "stood_from_step", "arrived"),
    ]
    return paged(asked, columns, rows)


VIEWS: dict[str, Callable[[Question], Table]] = {
    "rows": _rows,
    "collisions": _collisions,
    "closest": _closest,
    "speeds": _speeds_of_robots,
    "zones": zone_view,
    "sight": sight_view,
}
_EMPTY_MESSAGES: dict[str, Callable[[Question], str]] = {"zones": zones_empty_message, "sight": sight_empty_message}


# numbers --------------------------------------------------------------------------------------------------------------


def _speeds(trace: Trace, index: int, first: int, last: int) -> Floats:
    """(last - first + 1,) speed [m/s] of an object in the step before each row; 0 in the first row of the trace."""
    here = trace.pose[first : last + 1, index, :2]
    before = trace.pose[max(0, first - 1) : last, index, :2]
    if first == 0:
        before = np.concatenate([here[:1], before])
    speeds: Floats = np.linalg.norm(here - before, axis=1) / trace.step_time
    return speeds


def _most_steering(asked: Question, index: int, last: int) -> Cell:
    """Largest steering angle [rad] of a car, from the path of its rear axle; None for other drives and while it stands.

    A car with wheelbase L that drives at speed v and turns at rate w steers by atan(L w / v).
    """
    record = asked.run.resolved["objects"][index]
    drive = record.get("kinematics")
    if not isinstance(drive, dict) or drive.get("name") != "acker":
        return None
    wheelbase, trace = float(record.get("wheelbase") or 1.0), asked.trace
    angles = [
        math.atan2(wheelbase * abs(_turn_rate(trace, index, row)), speed)
        for row, speed in zip(range(asked.first, last + 1), _speeds(trace, index, asked.first, last), strict=True)
        if speed > _MIN_STEERED_SPEED
    ]
    return rounded(max(angles)) if angles else None


def _least_forward(asked: Question, index: int, last: int) -> Cell:
    """Least velocity along the heading [m/s]; None for omnidirectional drives, and without steps."""
    drive = asked.run.resolved["objects"][index].get("kinematics")
    name = drive.get("name") if isinstance(drive, dict) else None
    pose = asked.trace.pose[max(0, asked.first - 1) : last + 1, index]
    if len(pose) < 2 or not isinstance(name, str) or name.startswith("omni"):
        return None
    moved, heading = np.diff(pose[:, :2], axis=0), pose[:-1, 2]
    forward = moved[:, 0] * np.cos(heading) + moved[:, 1] * np.sin(heading)
    forward = forward[~np.isnan(forward)]
    if not forward.size:
        return None
    return rounded(float(forward.min()) / asked.trace.step_time)


def _turn_rate(trace: Trace, index: int, row: int) -> float:
    if row == 0:
        return 0.0
    turn = float(trace.pose[row, index, 2] - trace.pose[row - 1, index, 2])
    return math.remainder(turn, 2 * math.pi) / trace.step_time


def _speed_before(trace: Trace, name: str | None, row: int) -> Cell:
    """Speed in the step before a contact; None for a partner that is not an object of the trace."""
    if name not in trace.names:
        return None
    return rounded(float(_speeds(trace, trace.names.index(name), row, row)[0]))


def _longest_stop(speeds: Floats) -> tuple[int, int]:
    """First row and number of rows of the longest stop; the first row has no speed, so it never counts."""
    best, begin = (0, 0), 0
    for row, still in enumerate((speeds < _MIN_SPEED).tolist()):
        if not still or row == 0:
            begin = row + 1
        elif row + 1 - begin > best[1]:
            best = begin, row + 1 - begin
    return best


def _precise(value: float) -> float:
    """A number rounded to four decimals, or to two digits if that would make it 0."""
    return rounded(value) or (float(f"{value:.2g}") if value else 0.0)
