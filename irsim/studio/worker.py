"""The process that works for the studio: one job after the other from standard input, answers to standard output.

A job is a line of JSON with a ``task`` and its arguments. The answer is a line with ``result`` or ``error``; a run has
lines with a ``frame`` (base64) before it. The process ends with the studio.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from irsim.common.child import answers, limit, lines, write_line
from irsim.diagnostics.errors import IrsimError
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.studio.checking import check
from irsim.studio.completing import complete
from irsim.studio.editing import NotEdited, edit
from irsim.studio.running import page_of, run

__all__ = ["main"]

_MEMORY = 4 * 1024**3
"""Address space [bytes]."""
Put = Callable[[int, bytes], None]


def main() -> None:
    """Do jobs until standard input is closed."""
    pipe, jobs = answers(), lines()
    limit(memory=_MEMORY)

    def put(kind: int, content: bytes) -> None:
        write_line(pipe, {"frame": kind, "content": base64.b64encode(content).decode()})

    while True:
        job = json.loads(jobs.get())
        try:
            answer: dict[str, Any] = {"result": _TASKS[job.pop("task")](job, put)}
        except IrsimError as error:
            answer = {"error": str(error)}
        except (MemoryError, RecursionError) as error:
            answer = {"error": f"this is too large for the studio: {type(error).__name__}"}
        write_line(pipe, answer)


def _limits(job: Mapping[str, Any]) -> Limits:
    """Limits of a job, which reads files in the folder of the studio only."""
    return replace(DEFAULT_LIMITS, root=job["root"], bridges=False)


def _warm(job: Mapping[str, Any], put: Put) -> None:
    """Load what the first job would wait for."""
    _check({**job, "text": "robot: {goal: [1, 1]}"}, put)


def _check(job: Mapping[str, Any], put: Put) -> Any:
    return check(job["text"], job.get("path"), job.get("seed"), _limits(job))


def _complete(job: Mapping[str, Any], put: Put) -> Any:
    line, column = job.get("line"), job.get("column")
    return complete(job["text"], line, column) if isinstance(line, int) and isinstance(column, int) else None


def _edit(job: Mapping[str, Any], put: Put) -> Any:
    try:
        return {"text": edit(job["text"], job["edits"], _limits(job))}
    except NotEdited as error:
        return {"why": str(error)}


def _run(job: Mapping[str, Any], put: Put) -> Any:
    return run(job, _limits(job), put)


def _page(job: Mapping[str, Any], put: Put) -> Any:
    return page_of(job, _limits(job))


_TASKS: dict[str, Callable[[Mapping[str, Any], Put], Any]] = {
    "warm": _warm,
    "check": _check,
    "complete": _complete,
    "edit": _edit,
    "run": _run,
    "page": _page,
}
