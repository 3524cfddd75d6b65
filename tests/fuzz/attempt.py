"""Documents are tried in processes with the limits of a server and less memory: load, validate, three steps.

A process that dies takes only the document along that killed it.
"""

from __future__ import annotations

import os
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any, Literal

import irsim
from irsim.api import snapshot
from irsim.common.child import limit
from irsim.diagnostics.errors import IrsimError, PlacementError, ScenarioError
from irsim_evals.grader.limited import LimitError, run_all
from irsim_mcp.limits import ServerLimits, scenario_limits

__all__ = ["How", "Tally", "Wrong", "try_all"]

How = Literal["run", "render", "benchmark"]
"""The task for a document that validates."""

_SECONDS = 10.0
"""Processor time of one document: twice what the worst ones take, because machines differ, and their days do, too."""
_MEMORY = 1024**3
"""Address space of a process."""
_STEPS = 3
_RENEWED = 1000
"""Documents after which new processes are started: memory of many adds up to none."""


@dataclass(frozen=True)
class Wrong:
    """A document that should have been answered otherwise."""

    index: int
    text: str
    what: str


@dataclass
class Tally:
    """Results of all documents."""

    came_to: Counter[str] = field(default_factory=Counter)
    wrong: list[Wrong] = field(default_factory=list)
    slowest: tuple[float, int] = (0.0, -1)


def try_all(documents: Iterable[tuple[int, str]], *, workers: int = 2, how: How = "run") -> Tally:
    """Load, validate and run (or draw, or compare) documents.

    Args:
        documents: (number, text).
        workers: Processes at a time.
        how: The task for each document.
    """
    tally, rest = Tally(), iter(documents)
    with tempfile.TemporaryDirectory() as folder:
        while batch := list(islice(rest, _RENEWED)):
            results = run_all(_limited, [(text, folder, how) for _, text in batch], workers, _SECONDS, "document")
            for (index, text), result in zip(batch, results, strict=True):
                came_to, wrong, seconds = ("died", str(result), 0.0) if isinstance(result, LimitError) else result
                tally.came_to[came_to] += 1
                tally.slowest = max(tally.slowest, (seconds, index))
                if wrong is not None:
                    tally.wrong.append(Wrong(index, text, wrong))
    return tally


def _limited(text: str, folder: str, how: How) -> tuple[str, str | None, float]:
    """Try a document in the limited process: its result, what is wrong with it, and the processor time [s]."""
    os.chdir(folder)
    limit(memory=_MEMORY)
    warnings.simplefilter("error")
    begin = time.process_time()
    came_to, wrong = _attempt(text, scenario_limits(ServerLimits(), Path(folder)), how)
    return came_to, wrong, time.process_time() - begin


def _attempt(text: str, limits: Any, how: How) -> tuple[str, str | None]:
    """Result of a document, ``invalid``, ``refused`` or ``ran``, and the problem with that result, if any."""
    came_to = "invalid"
    try:
        report = irsim.validate(text=text, limits=limits)
        _check(report)
        try:
            result = _done(text, limits, how, strict=report.valid)
        except IrsimError as error:
            came_to = "refused" if report.valid else "invalid"
            _check_text(str(error))
            if report.valid and isinstance(error, ScenarioError) and not isinstance(error, PlacementError):
                return came_to, f"valid, but not run: {error}"
        else:
            came_to = "ran"
            _check(result)
    except MemoryError as error:
        return came_to, f"MemoryError at {_place(error)}"
    except Exception as error:
        return came_to, f"{type(error).__name__}: {error} at {_place(error)}"
    return came_to, None


def _done(text: str, limits: Any, how: How, *, strict: bool) -> Any:
    if how == "render":
        return snapshot(text=text, seed=1, steps=_STEPS, size=200, limits=limits, strict=strict)
    if how == "benchmark":
        return irsim.benchmark(text, seeds=2, steps=_STEPS, workers=1, limits=limits, strict=strict)
    return irsim.run(text=text, seed=1, steps=_STEPS, limits=limits, strict=strict)


def _check(result: Any) -> None:
    """A result that is written as JSON can be read back unchanged."""
    text = result.model_dump_json()
    again = type(result).model_validate_json(text).model_dump_json()
    assert again == text, "a result that is not read back as it was"
    assert len(text) < 2_000_000, f"a result of {len(text)} characters"


def _check_text(text: str) -> None:
    odd = {
        character
        for character in text
        if (ord(character) < 32 and character not in "\n\t") or ord(character) in (127, 0x202E)
    }
    assert not odd, f"control characters {odd} in {text[:200]!r}"
    assert len(text) < 200_000, f"a message of {len(text)} characters"


def _place(error: BaseException) -> str:
    frames = [f for f in traceback.extract_tb(error.__traceback__) if "irsim" in f.filename or "fuzz" in f.filename]
    return " < ".join(f"{Path(f.filename).name}:{f.lineno}" for f in reversed(frames[-4:]))
