"""What an answer cost: the calls that ``irsim-mcp --log-calls`` recorded.

The file lies where the agent could write. A line that is no record of a call is left out and reported.
"""

from __future__ import annotations

import json
import os
import stat
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from irsim_evals.grader.outcome import Cost

__all__ = ["CALLS_FILE", "cost_of"]

CALLS_FILE = "calls.jsonl"
"""Name under which the file is found in the folder of a case."""
_MAX_BYTES = 16_000_000
"""Size of a file that is read."""


class _Call(BaseModel):
    """A line of the file, as far as it matters here."""

    model_config = ConfigDict(extra="ignore", strict=True)

    tool: str
    error: bool
    tokens: Annotated[int, Field(ge=0, le=10**9)]


def cost_of(path: Path) -> Cost:
    """Number of calls, of failed ones, and tokens; all unknown if there is no file that can be read.

    Args:
        path: The file. A link is not followed.
    """
    try:
        data = _content(path)
    except FileNotFoundError:
        return Cost()
    except (OSError, ValueError) as error:
        return Cost(notes=[f"{path.name}: {getattr(error, 'strerror', None) or error}; its calls are not counted"])
    lines = [line for line in data.split(b"\n") if line.strip()]
    calls = [call for line in lines if (call := _read(line)) is not None]
    left_out = len(lines) - len(calls)
    notes = [f"{path.name}: lines that are no record of a call and are left out: {left_out} of {len(lines)}"]
    return Cost(
        calls=len(calls),
        errors=sum(call.error for call in calls),
        tokens=sum(call.tokens for call in calls),
        notes=notes if left_out else [],
    )


def _content(path: Path) -> bytes:
    """Content of an ordinary file of limited size; never waits, as a pipe would make it."""
    file = os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
    with os.fdopen(file, "rb") as stream:
        found = os.fstat(file)
        if not stat.S_ISREG(found.st_mode):
            raise ValueError("it is no ordinary file")
        if found.st_size > _MAX_BYTES:
            raise ValueError(f"it has {found.st_size:,} bytes, and at most {_MAX_BYTES:,} are read")
        return stream.read(_MAX_BYTES)


def _read(line: bytes) -> _Call | None:
    try:
        return _Call.model_validate(json.loads(line))
    except (ValueError, RecursionError, ValidationError):
        return None
