"""The recording behind a result of ``irsim.run``, for its table and its replay."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from irsim.api.run_scenario import run
from irsim.bridges.export.frames import run_frame
from irsim.common.arguments import as_given
from irsim.common.extras import library
from irsim.common.notebook import Page
from irsim.diagnostics.errors import InputError
from irsim.results.run import RunResult
from irsim.runs.reading import Run, open_run
from irsim.runs.replay.inline import replay_of_run

__all__ = ["recorded_run", "run_replay", "runs_table"]

_RECORD = "record the run: irsim.run(…, record=True)"


def runs_table(episodes: Sequence[RunResult], rows: str, objects: str | Sequence[str], ranges: bool) -> Any:
    """See :meth:`irsim.results.run.RunResult.to_pandas`."""
    if rows not in ("steps", "robots"):
        raise InputError(f"a table has no rows for {as_given(rows)}", "choose steps or robots", "rows")
    pandas = library("pandas")  # before a run is simulated again for nothing
    if rows == "steps":
        return run_frame([recorded_run(one) for one in episodes], objects, ranges=ranges)
    return pandas.DataFrame(
        [
            {"seed": one.seed, "steps": one.steps, "sim_time": one.sim_time, **robot.model_dump()}
            for one in episodes
            for robot in one.robots
        ]
    )


def run_replay(result: RunResult, height: int) -> Page:
    """See :meth:`irsim.results.run.RunResult.replay`."""
    return replay_of_run(recorded_run(result), height)


def recorded_run(result: RunResult) -> Run:
    """The recording of a run; one without a recording is simulated again once, into a temporary folder.

    Args:
        result: The result.

    Raises:
        InputError: The run cannot be simulated again, or differs from the first one then.
        RunError: The recording was deleted.
    """
    if result.artifacts:
        return open_run(Path(result.artifacts["scenario.yaml"]).parent)
    again = result._again
    if again is None or again.arguments is None or again.arguments["bridges"]:
        known = again is not None and again.arguments is not None
        why = "other programs took part in it" if known else "it was read from a file or another process"
        raise InputError(f"the result has no recording, and {why}", _RECORD)
    if not again.folder:
        folder = tempfile.mkdtemp(prefix="irsim-")
        weakref.finalize(again, shutil.rmtree, folder, ignore_errors=True)
        second = run(**again.arguments, record=Path(folder, "run"))
        if _facts(second) != _facts(result):
            raise InputError("simulating the run again gives another episode: its file or its policy changes", _RECORD)
        again.folder = str(Path(folder, "run"))
    return open_run(again.folder)


def _facts(result: RunResult) -> str:
    """All that the simulation decides."""
    return result.model_dump_json(include={"outcome", "steps", "robots", "events", "event_count", "zones"})
