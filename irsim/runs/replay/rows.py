"""The parts of a simulation that the replay page reads: its scene; poses, goals, flags and events of some rows.

A recorded run is packed whole (:mod:`irsim.runs.replay.data`), one that is being simulated in blocks
(:mod:`irsim.runs.replay.growing`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.text import clean
from irsim.objects.describe import describe_scene
from irsim.runs.replay.drawing import Columns, Integers, changes, page_grid, page_objects, page_zones, quantised
from irsim.simulation.events import BETWEEN_STEPS, Event
from irsim.simulation.trace import Trace

if TYPE_CHECKING:
    from irsim.results.run import RunResult
    from irsim.simulation.simulation import Simulation

__all__ = [
    "MAX_EVENTS",
    "add_flags",
    "add_goals",
    "add_poses",
    "ending_of",
    "flags_of",
    "page_event",
    "page_head",
    "page_scene",
    "steps_between_rows",
    "travellers",
]

FORMAT = 1
"""Version of the packed format."""
MAX_EVENTS = 4000
"""Number of events that the page shows; of later ones it shows how many there are."""
_MAX_POSES = 2_000_000
"""Number of rows times moving objects; of longer runs the page shows every Nth step."""
_TURN_QUANTUM = 2.0**-11
"""Resolution of headings [rad]."""
_MIN_EXPONENT = -13
"""Finest resolution of positions, as a power of two [m]."""
_MAX_EXPONENT = -4
"""Coarsest resolution of positions, as a power of two [m]."""


def page_scene(simulation: Simulation, columns: Columns) -> dict[str, Any]:
    """The part of a head that is known at the start of a run; cells of the map are added to the columns.

    Args:
        simulation: The simulation, at the start of an episode.
        columns: Gets ``cells`` and ``unknown``.
    """
    scene, world = describe_scene(simulation), simulation.scenario.world
    shapes, objects, lidars = page_objects(scene)
    grid = page_grid(scene)
    if grid is not None:
        columns.add("cells", grid.pop("runs"))
        if "unknown" in grid:
            columns.add("unknown", grid.pop("unknown"))
    x, y = (float(value) for value in world.offset)
    width, height = float(world.width), float(world.height)
    exponent = math.floor(math.log2(max(width, height) / 20_000))
    return {
        "format": FORMAT,
        "step_time": float(world.step_time),
        "world": [x, x + width, y, y + height],
        "quanta": [2.0 ** min(max(exponent, _MIN_EXPONENT), _MAX_EXPONENT), _TURN_QUANTUM],
        "shapes": shapes,
        "objects": objects,
        "lidars": lidars,
        "grid": grid,
        "zones": page_zones(world.zones),
    }


def page_head(
    scene: Mapping[str, Any],
    about: Mapping[str, Any],
    *,
    last_step: int,
    every: int,
    scans: str,
    events: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """The head of a run, recorded or live.

    Args:
        scene: See :func:`page_scene`.
        about: Facts about the run: ``run_id``, ``title``, ``status``, ``outcome``, ``seed``, ``notes`` …
        last_step: The last step that the page has.
        every: Number of steps from row to row.
        scans: ``none``, ``recorded`` or ``computed``.
        events: ``events``, ``event_count`` and ``left_out``; default: none yet.
    """
    known = {"events": [], "event_count": 0, "left_out": {}} if events is None else events
    return {**scene, **about, "last_step": last_step, "every": every, "scans": scans, **known}


def steps_between_rows(count: int, moving: int) -> int:
    """Number of steps between two rows that the page shows of ``count`` rows with so many moving objects."""
    return max(1, math.ceil(count * max(1, moving) / _MAX_POSES))


def travellers(objects: Sequence[Mapping[str, Any]]) -> NDArray[np.bool_]:
    """(N,) whether the page shows goals of an object."""
    return np.array([item["role"] == "robot" or "track" in item for item in objects], dtype=bool)


def flags_of(trace: Trace) -> Integers:
    """(T, N) sums of 1 (arrived), 2 (collided) and 4 (stopped)."""
    flags = np.zeros(trace.arrived.shape, dtype=np.int32)
    for bit, is_set in ((1, trace.arrived), (2, trace.collided), (4, trace.stopped)):
        flags[is_set] |= bit
    return flags


def add_poses(columns: Columns, poses: NDArray[np.float64], quantum: float) -> None:
    """Add ``x``, ``y``, ``heading`` (moving objects, rows); headings are unwrapped, so they exceed a full turn.

    Args:
        columns: The columns.
        poses: (T, M, 3) poses of the moving objects.
        quantum: Resolution of positions [m].
    """
    columns.add("x", quantised(poses[:, :, 0].T, quantum), 2)
    columns.add("y", quantised(poses[:, :, 1].T, quantum), 2)
    headings = np.nan_to_num(poses[:, :, 2].T, posinf=0.0, neginf=0.0)
    columns.add("heading", quantised(np.unwrap(headings, axis=1), _TURN_QUANTUM), 2)


def add_goals(
    columns: Columns,
    goal: NDArray[np.float64],
    shown: NDArray[np.bool_],
    quantum: float,
    before: NDArray[np.float64] | None = None,
) -> None:
    """Add ``goal_row``, ``goal_object``, ``goal_set``, ``goal_x``, ``goal_y``, ``goal_heading`` from that row on.

    Args:
        columns: The columns.
        goal: (T, N, 3) present goals, NaN without one.
        shown: (N,) objects whose goals are shown.
        quantum: Resolution of positions [m].
        before: (N, 3) goals in the row before; None before the first row, which then counts as a change.
    """
    skipped = 0 if before is None else 1
    goal = np.where(shown[:, None], goal if before is None else np.concatenate([before[None], goal]), np.nan)
    row, of = changes([goal[:, :, axis] for axis in range(3)])
    values = goal[row, of]
    there: NDArray[np.bool_] = np.isfinite(values[:, 0]) & np.isfinite(values[:, 1])
    keep = (there & (row >= skipped)) | (row > 0)
    columns.add("goal_row", row[keep] - skipped, 1)
    columns.add("goal_object", of[keep], 1)
    columns.add("goal_set", there[keep])
    for axis, name in enumerate(("goal_x", "goal_y")):
        columns.add(name, quantised(values[keep, axis], quantum), 1)
    columns.add("goal_heading", quantised(values[keep, 2], _TURN_QUANTUM), 1)


def add_flags(columns: Columns, flags: Integers, before: Integers | None = None) -> None:
    """Add ``flag_row``, ``flag_object``, ``flags``: flags from a row on.

    Args:
        columns: The columns.
        flags: (T, N) as :func:`flags_of` returns them.
        before: (N,) flags in the row before; None before the first row.
    """
    skipped = 0 if before is None else 1
    flags = flags if before is None else np.concatenate([before[None], flags])
    row, of = changes([flags])
    keep = ((flags[row, of] != 0) & (row >= skipped)) | (row > 0)
    columns.add("flag_row", row[keep] - skipped, 1)
    columns.add("flag_object", of[keep], 1)
    columns.add("flags", flags[row, of][keep])


def ending_of(result: RunResult) -> dict[str, str | None]:
    """The words of the page about how a run has ended: ``outcome``, ``summary`` and ``reason``."""
    reason = None if result.reason is None else clean(result.reason, 2000)
    return {"outcome": result.outcome, "summary": clean(result.summary, 1000), "reason": reason}


def page_event(event: Event, number: Mapping[str, int]) -> list[Any]:
    """An event as step, kind, object, partner or -1, x and y; then the zone, or the time within the step, if any.

    Args:
        event: The event.
        number: Name of an object -> its index.
    """
    partner = number.get(event.partner, -1) if event.partner is not None else -1
    return [event.step, event.kind, number[event.object], partner, _number(event.x), _number(event.y), *_where(event)]


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
