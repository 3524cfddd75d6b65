"""Pack everything that the replay page shows of a run into one block of bytes."""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.text import clean
from irsim.runs.reading import Run
from irsim.runs.replay.beliefs import believers_of
from irsim.runs.replay.drawing import Columns, folded
from irsim.runs.replay.rows import (
    MAX_EVENTS,
    add_flags,
    add_goals,
    add_poses,
    ending_of,
    flags_of,
    page_event,
    page_head,
    page_scene,
    steps_between_rows,
    travellers,
)
from irsim.runs.resimulation import initial_scene
from irsim.scenario.limits import Limits
from irsim.simulation.events import Event
from irsim.simulation.trace import Trace, measured_steps

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["Packed", "pack_run", "pack_trace"]

_RANKS = {
    "collision": 0,
    "passed_through": 0,
    "contact_between_steps": 0,
    "no_path": 1,
    "overshoot": 2,
    "arrival": 3,
    "believed_arrival": 3,
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
_ROW_PARTS = 1000
"""Number of parts into which the way from row to row is divided."""
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


def pack_run(run: Run, *, title: str | None = None, limits: Limits | None = None) -> Packed:
    """Pack a run and the shapes of its objects.

    Args:
        run: The recorded run; an interrupted run is shown as far as it was recorded.
        title: Title of the page; default: the name of the scenario, or the id of the run.
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
            "title": clean(title or (run.id if run.meta.get("scenario") is None else env.simulation.scenario.name)),
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
    columns = Columns()
    scene, starts = page_scene(simulation, columns), simulation.start_step
    objects, quantum = scene["objects"], scene["quanta"][0]
    moved = np.not_equal(trace.pose, trace.pose[:1]).any(axis=(0, 2))
    moving = np.flatnonzero(moved & ~np.isnan(trace.pose).all(axis=(0, 2)))
    for number, row in enumerate(moving.tolist()):
        objects[row]["track"] = number
    believers = believers_of(simulation).known_in(trace)
    scene |= believers.announce(objects, len(moving))
    every = steps_between_rows(len(trace), len(moving) + believers.count(trace))
    rows = _rows(len(trace), every)
    columns.add("step", trace.step[rows], 2)
    shown = np.concatenate([_held(trace.pose)[:, moving], believers.poses(trace)], axis=1)
    add_poses(columns, shown[rows], quantum)
    believers.add_tracks(columns, trace, rows, quantum)
    for number, item in enumerate(objects):
        item |= _presence(trace, number, int(starts[number]))
    add_goals(columns, trace.goal[rows], travellers(objects), quantum)
    add_flags(columns, flags_of(trace)[rows])
    scans = _add_scans(columns, trace, rows, scene["lidars"])
    last, listed = int(trace.step[-1]), _events(events, trace, objects)
    head = page_head(scene, about, last_step=last, every=every, scans=scans, events=listed)
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


def _rows(count: int, every: int) -> NDArray[np.int64]:
    """Rows of the trace that are shown, including the last one."""
    rows = np.arange(0, count, every)
    return rows if rows[-1] == count - 1 else np.append(rows, count - 1)


def _add_scans(columns: Columns, trace: Trace, rows: NDArray[np.int64], lidars: list[dict[str, Any]]) -> str:
    """Add ``scan0``, … (beams, rows): recorded ranges; a number above :data:`_RANGE_STEPS` means that nothing was hit.

    Of a lidar whose data may be old, ``from0``, … (rows,) says at which row it measured them, in parts of
    :data:`_ROW_PARTS`; below 0 before the first data.

    Returns:
        ``none`` without lidars, ``recorded`` if the page shows recorded ranges of all lidars, else ``computed``.
    """
    if not lidars:
        return "none"
    keys, timings = ([lidar.pop(name) for lidar in lidars] for name in ("key", "timing"))
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
        if any(timings[number]):
            columns.add(f"from{number}", _measured(trace, rows, *timings[number]), 2)
            lidar["from"] = f"from{number}"
    return scans


def _measured(trace: Trace, rows: NDArray[np.int64], rate: float, latency: float) -> NDArray[np.int64]:
    """(rows,) places between the shown rows at which a lidar measured what it shows; -1 before its first data."""
    steps = measured_steps(rate, latency, trace.step_time, trace.step[rows])
    places = np.interp(steps, trace.step[rows], np.arange(len(rows))) * _ROW_PARTS
    return np.where(steps < 0, -1, np.rint(places)).astype(np.int64)


def _ending(run: Run) -> dict[str, Any]:
    result = run.result
    if result is None:
        return {"outcome": None, "summary": f"This run is {run.status}.", "reason": None}
    return ending_of(result)


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
    shown = [page_event(event, number) for event in events]
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
        count = min(len(places), MAX_EVENTS - len(chosen))
        chosen += [places[k] for k in np.linspace(0, len(places) - 1, count).round().astype(int)]
    return [events[place] for place in sorted(chosen)]
