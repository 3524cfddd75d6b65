"""One document: load, validate, three steps. Runs in a process of its own, with the limits of a server and less memory.

Reads one JSON line per document (``{"index": …, "text": …}``) and writes one: what it came to, processor time [s], and
what is wrong, None if nothing is.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
from pathlib import Path
from typing import Any

__all__ = ["MEMORY", "SECONDS", "main"]

SECONDS = 10.0
"""Processor time of one document: twice what the worst ones take, because machines differ, and their days do, too."""
PATIENCE = 60.0
"""Time on the clock of one document, on a machine that does other things as well."""
MEMORY = 1024**3
"""Address space of the process."""
STEPS = 3


def main() -> None:
    """Do documents until there are no more."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    import irsim
    from irsim_mcp.limits import ServerLimits, scenario_limits

    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    assert irsim.validate
    warnings.simplefilter("error")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        limits = scenario_limits(ServerLimits(), Path(folder))
        for line in sys.stdin:
            item = json.loads(line)
            # No handlers: the system ends the process, wherever it is.
            signal.setitimer(signal.ITIMER_PROF, SECONDS)
            signal.setitimer(signal.ITIMER_REAL, PATIENCE)
            begin = time.process_time()
            came_to, wrong = attempt(item["text"], limits)
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            used = time.process_time() - begin
            answer = {"index": item["index"], "came_to": came_to, "wrong": wrong, "seconds": used}
            answers.write(json.dumps(answer) + "\n")
            answers.flush()


def attempt(text: str, limits: Any) -> tuple[str, str | None]:
    """Result of a document, ``invalid``, ``refused`` or ``ran``, and the problem with that result, if any."""
    import irsim
    from irsim.diagnostics.errors import IrsimError, PlacementError, ScenarioError

    came_to = "invalid"
    try:
        report = irsim.validate(text=text, limits=limits)
        _check(report)
        try:
            result = irsim.run(text=text, seed=1, steps=STEPS, limits=limits, strict=report.valid)
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


if __name__ == "__main__":
    main()
