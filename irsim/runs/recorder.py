"""Record a run while it is simulated, in pieces that are renamed into place, so that the folder is always readable."""

from __future__ import annotations

import json
import math
import os
import platform
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

import irsim._core as core
from irsim.common.files import Buffer
from irsim.common.hashing import digest
from irsim.common.installed import version
from irsim.common.outline import plain_outlines
from irsim.runs.cells import CELLS_FILE, pack_cells
from irsim.runs.chunks import PieceWriter, pack_chunk
from irsim.runs.files import DIGEST_LENGTH, Claim, RunError, claim, create_file, record_json, replace_file
from irsim.runs.plain_scenario import plain_scenario
from irsim.runs.store import (
    FILES,
    META,
    RESULT,
    SCENARIO_FILE,
    make_run_folder,
    mark_used,
    omission_notes,
    prune,
    remove,
    runs_path,
    tidy,
)
from irsim.simulation.engine import engine
from irsim.simulation.events import Event, read_events
from irsim.simulation.trace import gauges, recorded_rows, sensors

if TYPE_CHECKING:
    from irsim.results.run import RunResult
    from irsim.simulation.simulation import Simulation

__all__ = ["Recorder", "recording"]

_PIECE_BYTES = 4_000_000
"""Size of a piece of the trace."""
_WRITE_PERIOD_S = 0.5
"""Time [s] after which a piece is written even if it is small."""
_MAX_PIECE_NUMBERS = 8_000_000
"""Number of values that the poses of all objects have when a piece is read."""
_MAX_TRACE_BYTES = 200_000_000
"""Size of the trace of one run without its scans; of later steps only events and the result are recorded."""
_MAX_SCANS_BYTES = 80_000_000
"""Size in memory of the recorded scans of one run; later scans are not recorded."""
_MAX_SCAN_BYTES = 800_000
"""Size of all ranges of one step; larger scans are not recorded, as they would fill the limit within a few steps."""
_MAX_MAP_BYTES = 64_000_000
"""Size of a map file up to which the run keeps a copy of it."""
_PRUNING_INTERVAL_BYTES = 16_000_000
"""Number of bytes written between two checks whether older runs must be deleted."""


class Recorder:
    """Records the run of one simulation into a folder.

    Args:
        simulation: The simulation of one world, at its start.
        horizon: Greatest number of steps.
        scenario: Scenario file as the user named it, None for a text.
        options: Other options of the run, as JSON types.
        folder: A new or empty folder for the run, which is never deleted and has every step and scan; by default a
            folder in ``.irsim/runs`` of the current directory, which :mod:`irsim.runs.store` deletes later, and
            which leaves out what is too large.

    Attributes:
        folder: Folder of the run.
        run_id: Name of that folder.

    Raises:
        RunError: The folder is not empty, or is a link.
    """

    def __init__(
        self,
        simulation: Simulation,
        *,
        horizon: int,
        scenario: str | None,
        options: Mapping[str, Any],
        folder: Path | None = None,
    ) -> None:
        self._simulation = simulation
        self._runs = None if folder is not None else runs_path(make=True)
        if self._runs is not None:
            tidy(self._runs)
            self.folder = make_run_folder(self._runs, "scenario" if scenario is None else _stem(scenario))
        else:
            assert folder is not None
            self.folder = str(_make_empty_folder(folder))
        self.run_id = os.path.basename(self.folder)
        self._claim: Claim | None = None
        self._scan = 4 * simulation.world.beams_per_world + 8 * simulation.world.readings_per_world  # bytes in one step
        limited = self._runs is not None
        self._scans = scans = 0 < self._scan <= (_MAX_SCAN_BYTES if limited else sys.maxsize)
        self._scan_rows = (_MAX_SCANS_BYTES if limited else sys.maxsize) // self._scan if scans else 0  # rows left
        self._most_bytes = _MAX_TRACE_BYTES if limited else sys.maxsize
        self._piece_rows = max(1, _MAX_PIECE_NUMBERS // max(1, 3 * simulation.objects))
        self._revision = simulation.revision
        kept, self._movers = sensors(simulation) if scans else [], recorded_rows(simulation)
        told = gauges(simulation) if scans else []
        seed = int(simulation.key()[0])
        self._log = _log_of(simulation, self._movers, scans)
        self._spare: core.Log | None = None  # holds the piece that is being written, or nothing
        self._writer = PieceWriter()
        self._log.attach(simulation.state)
        self._log.add(simulation.state)
        simulation.log = self._log
        self._pieces = self._events = self._bytes = self._scan_bytes = self._pruned_at = 0
        self._done = False
        self._due = time.monotonic() + _WRITE_PERIOD_S
        source = simulation.scenario.source
        self._meta: dict[str, Any] = {
            "id": self.run_id,
            "cancelled": False,
            "created": time.strftime("%Y-%m-%dT%H:%M:%S+00:00", time.gmtime()),
            "scenario": scenario,
            "folder": None if source is None else os.path.dirname(os.path.abspath(source)),
            "seed": seed,
            "horizon": horizon,
            "step_time": float(simulation.scenario.world.step_time),
            "options": dict(options),
            "names": [record.name for record in simulation.scenario.objects],
            "sensors": [[key, beams.stop - beams.start] for key, beams in kept],
            **({"gauges": told} if told else {}),
            "scans": scans or not self._scan,
            "trace_until": None,
            "scans_until": None,
            **_versions(),
        }
        try:
            self._claim = claim(self._path(SCENARIO_FILE), _text_of(simulation).encode())
            outlines = plain_outlines(simulation.state, len(self._meta["names"]))
            resolved = plain_scenario(simulation, outlines)
            create_file(self._path("resolved.json"), resolved)
            self._meta["resolved"] = digest(resolved)[:DIGEST_LENGTH]
            self._meta["maps"] = self._copy_maps()
            self._keep_cells()
            self._write_meta()
        except BaseException:
            self._stop()
            if self._runs is not None:
                remove(Path(self.folder))
            raise

    def _copy_maps(self) -> list[list[str]]:
        """Copy the files of the map, which may change before the run is read, and return their names and copies."""
        kept = list[list[str]]()
        for name, path in self._simulation.scenario.map_files.items():
            ending = os.path.splitext(path)[1]
            file = f"map-{len(kept)}{ending if ending[1:].isalnum() and len(ending) < 11 else ''}"
            try:
                if os.path.getsize(path) > _MAX_MAP_BYTES:
                    continue
                content = Path(path).read_bytes()
            except OSError as error:
                raise RunError("file-access", f"'{path}' cannot be read: {error.strerror or error}") from None
            create_file(self._path(file), content)
            kept.append([name, file])
        return kept

    def _keep_cells(self) -> None:
        """Write the occupied cells of the map, from which contacts with it can be checked without its file."""
        simulation = self._simulation
        row = next((row for row, record in enumerate(simulation.scenario.objects) if record.shape.name == "map"), None)
        grid = None if row is None else simulation.state.cells(row)
        if grid is None or math.prod(grid.shape) > 8 * _MAX_MAP_BYTES:
            return
        content = pack_cells(grid.occupied, grid.origin, grid.cell)
        create_file(self._path(CELLS_FILE), content)
        self._meta["cells"] = digest(content)[:DIGEST_LENGTH]

    def advance(self, steps: int, *, until_done: bool = False) -> int:
        """Advance the simulation like :meth:`irsim.simulation.simulation.Simulation.advance`, and record it."""
        done = 0
        while done < steps:
            some = min(steps - done, self._most_steps())
            more = self._simulation.advance(some, until_done=until_done)
            done += more
            self.write_if_due()
            if more < some:
                break
        return done

    def _most_steps(self) -> int:
        """Number of steps until a piece may be due: pieces stay small, and scans always end at the same step."""
        if not self._scans:
            return 2**62
        return max(1, min(_PIECE_BYTES // self._scan, self._scan_rows - self._log.rows))

    def write_if_due(self) -> None:
        """Write a piece if it is large or old enough; to be called often, best after every step."""
        if self._simulation.revision != self._revision:
            raise RunError(
                "unreadable-run", "objects were added or removed: only runs with the same objects are recorded"
            )
        if self._scans and self._log.rows >= self._scan_rows:
            self._end_scans()
        elif self._log.bytes >= _PIECE_BYTES or self._log.rows >= self._piece_rows or time.monotonic() >= self._due:
            self._flush()

    def finish(self, result: RunResult) -> None:
        """Write the last piece and the result, which gets the id and the files of the run."""
        self._flush(last=True)
        result.notes = [*omission_notes(self._meta, result.steps), *result.notes]
        result.run_id = self.run_id
        result.artifacts = {name: self._path(name) for name in FILES}
        self._write(RESULT, record_json(result, indent=1))
        mark_used(self.folder)
        self._stop()

    def close(self, *, cancelled: bool = False) -> None:
        """End the recording; if there is no result yet, what was recorded so far is kept."""
        if self._done:
            return
        try:
            if cancelled:  # first: an interrupt in the middle of a piece may have left nothing that can be written
                self._write_meta(cancelled=True)
            self._flush(last=True)
            mark_used(self.folder)
        finally:
            self._stop()

    def _stop(self) -> None:
        self._done = True
        self._detach()
        with suppress(BaseException):  # the error that ends the recording is already on its way
            self._writer.wait()
        if self._claim is not None:
            self._claim.release()

    def _end_scans(self) -> None:
        """Write the last scans and record later steps without them."""
        last = self._log.first + self._log.rows - 1
        self._flush()
        self._scans = False
        if self._simulation.log is None:
            return
        self._detach()
        self._spare = None
        self._attach(_log_of(self._simulation, self._movers, scans=False))
        self._write_meta(scans_until=last)

    def _attach(self, log: core.Log) -> None:
        """Record the next steps in a log."""
        self._log = log
        log.attach(self._simulation.state)
        self._simulation.log = log

    def _detach(self) -> None:
        self._simulation.log = None
        self._log.detach(self._simulation.state)

    def _flush(self, *, last: bool = False) -> None:
        """Write the trace and events since the last piece, or only the events once the trace is too large.

        Args:
            last: Whether the run is over; the piece is then complete when this returns. Other pieces are written in a
                thread, while the simulation fills another log.
        """
        self._writer.wait()
        events = read_events(self._simulation, start=self._events)
        self._events += len(events)
        log, number = self._log, f"{self._pieces:04d}"
        if log.rows or events:
            self._pieces += 1
        if log.rows:
            self._bytes += log.bytes
            self._scan_bytes += 4 * log.ranges.size + 8 * log.readings.size
            self._scan_rows -= log.rows
            until, pose = log.first + log.rows - 1, self._simulation.pose.copy()
            full = self._bytes - self._scan_bytes >= self._most_bytes
            write = partial(self._write_piece, f"trace-{number}.npz", log, pose, events)
            if last or full:
                write()
                log.clear()
            else:
                self._exchange_logs()
                self._writer.submit(write)
            if full:
                self._scans = False
                self._detach()
                self._write_meta(trace_until=until)
        elif events:
            self._write(f"events-{number}.json", to_json([event._asdict() for event in events]))
        self._due = time.monotonic() + _WRITE_PERIOD_S

    def _exchange_logs(self) -> None:
        """Continue with the spare log, so that the present one can be written; its memory is used again later."""
        spare = self._spare or _log_of(self._simulation, self._movers, self._scans)
        spare.clear()
        self._detach()
        self._spare = self._log
        self._attach(spare)

    def _write_piece(self, name: str, log: core.Log, pose: NDArray[np.float64], events: Sequence[Event]) -> None:
        """Write a piece, and delete older runs from time to time."""
        self._write(name, *pack_chunk(log, self._movers, pose, [event._asdict() for event in events]))
        if self._runs is not None and self._bytes - self._pruned_at > _PRUNING_INTERVAL_BYTES:
            self._pruned_at = self._bytes
            prune(Path(self._runs), keep=self.run_id)

    def _write_meta(self, **changes: Any) -> None:
        self._meta.update(changes)
        self._write(META, record_json(self._meta, indent=1))

    def _write(self, name: str, *parts: Buffer) -> None:
        replace_file(self._path(name), *parts)

    def _path(self, name: str) -> str:
        return f"{self.folder}{os.sep}{name}"


@contextmanager
def recording(
    simulation: Simulation,
    path: str | Path | None,
    record: bool | str | Path,
    *,
    horizon: int,
    options: Mapping[str, Any],
) -> Iterator[Recorder | None]:
    """Context with a recorder for the episode of a simulation, None if it is not recorded.

    Args:
        simulation: The simulation of one world, at its start.
        path: Scenario file, None for a text.
        record: Whether to record, or the folder to record to.
        horizon: Greatest number of steps.
        options: Other options of the run: ``strict``, ``imports``, ``behavior`` if it replaces the behaviors of the
            robots, and ``perturb`` if starts were perturbed.
    """
    if record is False:
        yield None
        return
    recorder = Recorder(
        simulation,
        horizon=horizon,
        scenario=None if path is None else str(path),
        options=options,
        folder=None if record is True else Path(record),
    )
    try:
        yield recorder
    except KeyboardInterrupt:
        recorder.close(cancelled=True)
        raise
    finally:
        recorder.close()


def _log_of(simulation: Simulation, movers: list[int], scans: bool) -> core.Log:
    """A log of the objects in some rows."""
    columns = max((simulation.scenario.objects[row].vel_dim for row in movers), default=0)
    return core.Log(simulation.world, movers, min(3, columns), scans)


def _stem(scenario: str) -> str:
    return os.path.splitext(os.path.basename(scenario))[0]


def _make_empty_folder(folder: Path) -> Path:
    """Make a folder and return its path; a folder that exists already must be empty."""
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise RunError("file-exists", f"'{folder}' exists and is not empty", "name another folder for the run")
    folder.mkdir(parents=True, exist_ok=True)
    return folder.resolve()


def _text_of(simulation: Simulation) -> str:
    """The scenario as the user wrote it."""
    scenario = simulation.scenario
    return scenario.text if scenario.text is not None else json.dumps(scenario.document, default=str)


def _versions() -> dict[str, str]:
    return {
        "irsim": version(),
        "engine": engine(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "platform": platform.platform(),
    }
