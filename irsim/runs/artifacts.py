"""The files of a run as text, of which a caller can read a part at a time."""

from __future__ import annotations

import base64
import csv
import io
import json
from typing import Any

import numpy as np

from irsim.common.text import clean
from irsim.runs.files import RunError, text_of
from irsim.runs.inspection import inspect_run
from irsim.runs.reading import Run
from irsim.runs.replay.data import pack_run
from irsim.runs.store import ARTIFACTS, FILES
from irsim.scenario.limits import Limits

__all__ = ["artifact"]

_DECIMALS = 4
"""Decimals of poses."""
_COLUMNS = ("x", "y", "heading", "speed", "turn_rate", "control", "goal", "status")


def artifact(
    run: Run,
    name: str,
    *,
    from_step: int = 0,
    to_step: int | None = None,
    every: int = 1,
    robot: str | None = None,
    offset: int = 0,
    most: int = 1_000_000,
    limits: Limits | None = None,
) -> str:
    """A part of one artifact of a run.

    Files are read from character ``offset`` on; events and traces from ``from_step`` to ``to_step``. A part that is
    cut by ``most`` ends with a whole step; ``next_step`` of ``events.json`` and ``trace.json`` is the step to continue
    with, null at the end. In ``trace.csv`` it is the last line, ``# next_step: N``, which the last part lacks.
    ``replay.json`` is what the page of :mod:`irsim.replay` reads: ``data`` holds the characters from ``offset`` on of a
    packed run in base64, which has ``total`` characters.

    Args:
        run: The run.
        name: One of :data:`irsim.runs.store.ARTIFACTS`.
        from_step: First step.
        to_step: Last step; default: the last step of the run.
        every: Take every Nth step of a trace.
        robot: Only this object; ``trace.json`` then has its ranges, too.
        offset: First character of a file.
        most: Greatest number of bytes.
        limits: Limits of the reader of the scenario, which ``replay.json`` needs.

    Raises:
        RunError: There is no such artifact, object or step.
    """
    if name in FILES:
        text = text_of(run.folder, name)
        if text is None:
            raise RunError("unknown-run", f"run {run.id} has no {name}: it is {run.status}")
        return text[offset:].encode()[:most].decode(errors="ignore")
    if name == "replay.json":
        return _replay(run, offset, most, limits)
    if name == "events.json":
        return _events(run, from_step, to_step, robot, most)
    if name == "trace.json":
        return _trace(run, from_step, to_step, every, robot, most)
    if name == "trace.csv":
        return _csv(run, from_step, to_step, every, robot, most)
    raise RunError("unknown-run", f"a run has no {clean(name)!r}", f"there are {', '.join(ARTIFACTS)}")


def _replay(run: Run, offset: int, most: int, limits: Limits | None) -> str:
    text = base64.b64encode(pack_run(run, limits=limits).data).decode()
    head = json.dumps({"run_id": run.id, "offset": offset, "total": len(text)})
    return f'{head[:-1]}, "data": "{text[offset : offset + most - len(head) - 20]}"}}'


def _events(run: Run, from_step: int, to_step: int | None, robot: str | None, most: int) -> str:
    if robot is not None:
        run.index_of(robot)  # refuses names that no object has
    if from_step > max([run.last_step, 0, *(event.step for event in run.events)]):
        raise RunError("step-out-of-range", f"run {run.id} has no step {from_step}", run.extent, where="from_step")
    space, parts, next_step = most - 200, list[tuple[int, str]](), None
    for event in run.events:
        if event.step < from_step or (to_step is not None and event.step > to_step):
            continue
        if robot is not None and robot not in (event.object, event.partner):
            continue
        part = json.dumps({field: getattr(event, field) for field in event._fields})
        space -= len(part) + 2
        if space < 0:
            next_step = event.step
            break
        parts.append((event.step, part))
    whole_steps = [part for step, part in parts if step != next_step]
    head = json.dumps({"run_id": run.id, "status": run.status, "next_step": next_step})
    return f'{head[:-1]}, "events": [{", ".join(whole_steps)}]}}'


def _trace(run: Run, from_step: int, to_step: int | None, every: int, robot: str | None, most: int) -> str:
    trace = run.trace()
    begin, end = int(trace.step[0]), int(trace.step[-1])
    if not begin <= from_step <= end:
        raise RunError("step-out-of-range", f"run {run.id} has no step {from_step}", run.extent, where="from_step")
    objects = slice(None) if robot is None else [run.index_of(robot)]
    last = end if to_step is None else min(to_step, end)
    rows = range(from_step - begin, last - begin + 1, max(1, every))
    keys = [] if robot is None else [key for key in trace.ranges if key.startswith(f"{robot}/")]
    head: dict[str, Any] = {
        "run_id": run.id,
        "status": run.status,
        "step_time": trace.step_time,
        "names": [name for name in trace.names if robot in (None, name)],
        "last_step": end,
        "every": max(1, every),
        "notes": run.notes,
    }
    space, parts, next_step = most - len(json.dumps(head)) - 100, list[str](), None
    for row in rows:
        values: dict[str, Any] = {
            "step": int(trace.step[row]),
            "pose": np.round(trace.pose[row, objects], _DECIMALS).tolist(),
            "flags": (
                trace.arrived[row, objects] + 2 * trace.collided[row, objects] + 4 * trace.stopped[row, objects]
            ).tolist(),
        }
        if keys:
            values["ranges"] = {
                key: _finite(trace.ranges[key][row]) if row < len(trace.ranges[key]) else None for key in keys
            }
        part = json.dumps(values, separators=(",", ":"))
        space -= len(part) + 1
        if space < 0:
            next_step = int(trace.step[row])
            break
        parts.append(part)
    text = json.dumps({**head, "next_step": next_step})
    return f'{text[:-1]}, "rows": [{",".join(parts)}]}}'


def _csv(run: Run, from_step: int, to_step: int | None, every: int, robot: str | None, most: int) -> str:
    table = inspect_run(
        run, robot=robot, from_step=from_step, to_step=to_step, every=max(1, every), fields=_COLUMNS, limit=None
    )
    out, at = io.StringIO(), table.columns.index("step")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(table.columns)
    whole, step = out.tell(), None  # characters up to the last whole step
    for row in table.rows:
        if row[at] != step:
            whole, step = out.tell(), row[at]
        writer.writerow([clean(cell, 200) if isinstance(cell, str) else cell for cell in row])
        if out.tell() > most - 100:
            return f"{out.getvalue()[:whole]}# next_step: {step}\n"
    return out.getvalue()


def _finite(ranges: Any) -> list[float | None]:
    """Ranges rounded to a millimetre; None where a beam hit nothing."""
    return [round(float(value), 3) if np.isfinite(value) else None for value in ranges]
