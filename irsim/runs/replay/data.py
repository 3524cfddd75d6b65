"""Pack everything that the replay page shows of a run into one block of bytes."""

from __future__ import annotations

import math
import zlib
from collections import Counter
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.text import clean
from irsim.objects.describe import describe_scene
from irsim.runs.reading import Run
from irsim.runs.replay.drawing import Columns, changes, folded, page_grid, page_objects, page_zones, quantised
from irsim.runs.resimulation import initial_scene
from irsim.scenario.limits import Limits
from irsim.simulation.events import BETWEEN_STEPS, Event
from irsim.simulation.trace import Trace

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Packed", "pack_run", "pack_trace"]

FORMAT = 1
"""Version of the packed format."""
_MAX_POSES = 2_000_000
"""Number of rows times moving objects; of longer runs the page shows every Nth step."""
_MAX_EVENTS = 4000
"""Number of events that the page shows."""
_RANKS = {
    "collision": 0,
    "passed_through": 0,
    "contact_between_steps": 0,
    "no_path": 1,
    "overshoot": 2,
    "arrival": 3,
    "line_crossing": 4,
    "zone_entry": 4,
    "zone_exit": 4,
    "waypoint": 5,
    "sight_start": 6,
    "sight_end": 6,
}
"""Importance of the kinds of events, the most important first."""
_MAX_RANGES = 2_000_000
"""Number of recorded ranges up to which the page shows them; of longer scans it computes the ranges."""
_MAX_SCANS_BYTES = 700_000
"""Compressed size of the recorded scans up to which the page shows them."""
_TURN_QUANTUM = 2.0**-11
"""Resolution of headings [rad]."""
_MIN_EXPONENT = -13
"""Finest resolution of positions, as a power of two [m]."""
_MAX_EXPONENT = -4
"""Coarsest resolution of positions, as a power of two [m]."""
_RANGE_STEPS = 4000
"""Number of steps into which the range of a sensor is divided."""


@dataclass(frozen=True)
class Packed:
    """A run as the page reads it.

    Attributes:
        data: The compressed block, in the format of :class:`irsim.runs.replay.drawing.Columns`.
        head: Its head, as plain data.
    """

    data: bytes
    head: dict[str, Any]


def pack_run(run: Run, *, limits: Limits | None = None) -> Packed:
    """Pack a run and the shapes of its objects.

    Args:
        run: The recorded run; an interrupted run is shown as far as it was recorded.
        limits: Limits of the reader of its scenario.

    Raises:
        RunError: The run cannot be read, or its scenario now has other initial poses, because a map or irsim itself has
            changed.
        ScenarioError: The scenario has errors, for example because another file of it has changed.
    """
    trace = run.trace()
    with initial_scene(run, limits) as env:
        about = {
            "run_id": run.id,
            "title": run.id if run.meta.get("scenario") is None else clean(env.simulation.scenario.name),
            "status": run.status,
            **_ending(run),
            "seed": int(run.meta["seed"]),
            "irsim": clean(run.meta.get("irsim", "")),
            "notes": run.notes,
        }
        return pack_trace(trace, run.events, env.simulation, about)


def pack_trace(trace: Trace, events: Sequence[Event], simulation: Simulation, about: Mapping[str, Any]) -> Packed:
    """Pack the trace of an episode and the shapes of its objects.

    Args:
        trace: The trace.
        events: The events of the episode.
        simulation: A simulation of the same scene, at its start.
        about: The words of the page about the run: ``run_id``, ``title``, ``status``, ``outcome``, ``summary``,
            ``reason``, ``seed``, ``irsim`` and ``notes``.
    """
    scene = describe_scene(simulation)
    shapes, objects, lidars = page_objects(scene)
    grid = page_grid(scene)
    world, starts = simulation.scenario.world, simulation.start_step
    columns = Columns()
    x, y = (float(value) for value in world.offset)
    width, height = float(world.width), float(world.height)
    moved = np.not_equal(trace.pose, trace.pose[:1]).any(axis=(0, 2))
    moving = np.flatnonzero(moved & ~np.isnan(trace.pose).all(axis=(0, 2)))
    for number, row in enumerate(moving.tolist()):
        objects[row]["track"] = number
    rows, every = _rows(len(trace), len(moving))
    quantum = 2.0 ** min(max(math.floor(math.log2(max(width, height) / 20_000)), _MIN_EXPONENT), _MAX_EXPONENT)
    columns.add("step", trace.step[rows], 2)
    _add_poses(columns, _held(trace.pose)[np.ix_(rows, moving)], quantum)
    for number, item in enumerate(objects):
        item |= _presence(trace, number, int(starts[number]))
    travellers = np.array([item["role"] == "robot" or "track" in item for item in objects], dtype=bool)
    _add_goals(columns, np.where(travellers[:, None], trace.goal[rows], np.nan), quantum)
    _add_flags(columns, trace, rows)
    scans = _add_scans(columns, trace, rows, lidars)
    if grid is not None:
        columns.add("cells", grid.pop("runs"))
        if "unknown" in grid:
            columns.add("unknown", grid.pop("unknown"))
    head = {
        "format": FORMAT,
        **about,
        "step_time": trace.step_time,
        "last_step": int(trace.step[-1]),
        "every": every,
        "world": [x, x + width, y, y + height],
        "quanta": [quantum, _TURN_QUANTUM],
        "shapes": shapes,
        "objects": objects,
        "lidars": lidars,
        "scans": scans,
        "grid": grid,
        "zones": page_zones(world.zones),
        **_events(events, trace, objects),
    }
    return Packed(columns.block(head), head)


def _presence(trace: Trace, number: int, start: int) -> dict[str, int]:
    """The step ``from`` which an object is in the world, and ``until`` which it stands at its start, if not 0.

    ``to`` is the last step at which an object that leaves before the end is in the world.
    """
    present = np.flatnonzero(~np.isnan(trace.pose[:, number, 0]))
    steps = trace.step[present[:1]].tolist() or [int(trace.step[-1]) + 1]
    bounds = {"from": steps[0], "until": start}
    result = {key: step for key, step in bounds.items() if step > int(trace.step[0])}
    return result | ({"to": int(trace.step[present[-1]])} if present.size and present[-1] < len(trace) - 1 else {})


def _held(pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """Poses in which an object that comes later stands at its start before, and one that leaves at its end after."""
    absent = np.isnan(pose[:, :, 0])
    partly = np.flatnonzero((absent[0] | absent[-1]) & ~absent.all(axis=0))
    if partly.size:
        pose = pose.copy()
        for number in partly.tolist():
            present = np.flatnonzero(~absent[:, number])
            first, last = int(present[0]), int(present[-1])
            pose[:first, number] = pose[first, number]
            pose[last + 1 :, number] = pose[last, number]
    return pose


def _rows(count: int, moving: int) -> tuple[NDArray[np.int64], int]:
    """Rows of the trace that are shown, including the last one, and the number of steps between them."""
    every = max(1, math.ceil(count * max(1, moving) / _MAX_POSES))
    rows = np.arange(0, count, every)
    return (rows if rows[-1] == count - 1 else np.append(rows, count - 1)), every


def _add_poses(columns: Columns, poses: NDArray[np.float64], quantum: float) -> None:
    """Add ``x``, ``y``, ``heading`` (moving objects, rows); headings are unwrapped, so they exceed a full turn."""
    columns.add("x", quantised(poses[:, :, 0].T, quantum), 2)
    columns.add("y", quantised(poses[:, :, 1].T, quantum), 2)
    headings = np.nan_to_num(poses[:, :, 2].T, posinf=0.0, neginf=0.0)
    columns.add("heading", quantised(np.unwrap(headings, axis=1), _TURN_QUANTUM), 2)


def _add_goals(columns: Columns, goal: NDArray[np.float64], quantum: float) -> None:
    """Add ``goal_row``, ``goal_object``, ``goal_set``, ``goal_x``, ``goal_y``, ``goal_heading`` from that row on."""
    row, of = changes([goal[:, :, axis] for axis in range(3)])
    values = goal[row, of]
    there: NDArray[np.bool_] = np.isfinite(values[:, 0]) & np.isfinite(values[:, 1])
    keep = there | (row > 0)
    columns.add("goal_row", row[keep], 1)
    columns.add("goal_object", of[keep], 1)
    columns.add("goal_set", there[keep])
    for axis, name in enumerate(("goal_x", "goal_y")):
        columns.add(name, quantised(values[keep, axis], quantum), 1)
    columns.add("goal_heading", quantised(values[keep, 2], _TURN_QUANTUM), 1)


def _add_flags(columns: Columns, trace: Trace, rows: NDArray[np.int64]) -> None:
    """Add ``flag_row``, ``flag_object``, ``flags`` (1 arrived, 2 collided, 4 stopped): flags from a row on."""
    flags = np.zeros((len(rows), len(trace.names)), dtype=np.int32)
    for bit, is_set in ((1, trace.arrived), (2, trace.collided), (4, trace.stopped)):
        flags[is_set[rows]] |= bit
    row, of = changes([flags])
    keep = (flags[row, of] != 0) | (row > 0)
    columns.add("flag_row", row[keep], 1)
    columns.add("flag_object", of[keep], 1)
    columns.add("flags", flags[row, of][keep])


def _add_scans(columns: Columns, trace: Trace, rows: NDArray[np.int64], lidars: list[dict[str, Any]]) -> str:
    """Add ``scan0``, … (beams, rows): recorded ranges; a number above :data:`_RANGE_STEPS` means that nothing was hit.

    Returns:
        ``none`` without lidars, ``recorded`` if the page shows recorded ranges of all lidars, else ``computed``.
    """
    if not lidars:
        return "none"
    keys = [lidar.pop("key") for lidar in lidars]
    known = [block if block is not None and len(block) == len(trace) else None for block in map(trace.ranges.get, keys)]
    if sum(0 if block is None else block.shape[1] * len(rows) for block in known) > _MAX_RANGES:
        return "computed"
    space, scans = _MAX_SCANS_BYTES, "recorded"
    for number, (lidar, block) in enumerate(zip(lidars, known, strict=True)):
        if block is None or block.shape[1] != lidar["beams"]:
            scans = "computed"
            continue
        quantum = lidar["range_max"] / _RANGE_STEPS
        seen = block[rows]
        parts = np.full(seen.shape, _RANGE_STEPS + 1.0)
        np.divide(seen, quantum, out=parts, where=np.isfinite(seen))
        values = np.clip(np.rint(parts), 0, _RANGE_STEPS + 1).astype(np.int32).T
        space -= len(zlib.compress(folded(values, 1), 1))
        if space < 0:
            return "computed"
        columns.add(f"scan{number}", values, 1)
        lidar["scan"] = f"scan{number}"
        lidar["quantum"] = quantum
    return scans


def _ending(run: Run) -> dict[str, Any]:
    result = run.result
    if result is None:
        return {"outcome": None, "summary": f"This run is {run.status}.", "reason": None}
    reason = None if result.reason is None else clean(result.reason, 2000)
    return {"outcome": result.outcome, "summary": clean(result.summary, 1000), "reason": reason}


def _events(recorded: Sequence[Event], trace: Trace, objects: list[dict[str, Any]]) -> dict[str, Any]:
    """Events as [step, kind, object, partner or -1, x, y], and how many there are and are left out.

    There are further values: the zone, if any; of a contact between steps an empty zone and the time within the step.
    """
    number = {name: row for row, name in enumerate(trace.names)}
    last = int(trace.step[-1])
    events = [event for event in recorded if event.step <= last and event.object in number]
    count = len(events)
    left = Counter(event.kind for event in events)
    events = _most_important(events, {trace.names[k] for k, item in enumerate(objects) if item["role"] == "robot"})
    left.subtract(event.kind for event in events)
    shown = [
        [
            event.step,
            event.kind,
            number[event.object],
            number.get(event.partner, -1) if event.partner is not None else -1,
            _number(event.x),
            _number(event.y),
            *_where(event),
        ]
        for event in events
    ]
    return {"events": shown, "event_count": count, "left_out": {kind: most for kind, most in left.items() if most}}


def _most_important(events: list[Event], robots: Container[str]) -> list[Event]:
    """The events that are shown, by rank of their kind, and within a kind robots before other objects.

    If the events of a rank do not all fit, they are thinned evenly.
    """
    ranks: dict[tuple[int, bool], list[int]] = {}
    for place, event in enumerate(events):
        others = event.object not in robots and (event.partner is None or event.partner not in robots)
        ranks.setdefault((_RANKS.get(event.kind, len(_RANKS)), others), []).append(place)
    chosen = list[int]()
    for rank in sorted(ranks):
        places = ranks[rank]
        count = min(len(places), _MAX_EVENTS - len(chosen))
        chosen += [places[k] for k in np.linspace(0, len(places) - 1, count).round().astype(int)]
    return [events[place] for place in sorted(chosen)]


def _where(event: Event) -> list[Any]:
    """The zone of an event and the direction in which a line is crossed, or the time within the step; else nothing."""
    if event.kind in BETWEEN_STEPS:
        return ["", round(event.time, 6)]
    if event.zone is None:
        return []
    way = "" if event.direction is None else f" ({event.direction.replace('_', ' ')})"
    return [clean(event.zone) + way]


def _number(value: float) -> float:
    return round(value, 3) if math.isfinite(value) else 0.0
