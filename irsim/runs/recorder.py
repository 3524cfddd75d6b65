"""Writes a run while it happens, in pieces that are renamed into place: what is there can be read, whatever happens."""

from __future__ import annotations

import json
import os
import platform
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic_core import to_json

import irsim._core as core
from irsim.runs.chunks import chunk_of
from irsim.runs.files import Buffer, Claim, RunError, begun, claim, written
from irsim.runs.omissions import lacking
from irsim.runs.plain_scenario import plain_scenario
from irsim.runs.pruning import prune, remove, tidy
from irsim.runs.store import BEGUN, FILES, META, RESULT, made_folder, runs_place, used
from irsim.simulation.trace import sensors

if TYPE_CHECKING:
    from irsim.env import Env
    from irsim.results.results import RunResult
    from irsim.simulation.simulation import Simulation

__all__ = ["Recorder", "recording"]

_PIECE = 4_000_000
"""Bytes of a piece of the trace."""
_PERIOD = 0.5
"""Seconds after which a piece is written at the latest."""
_MOST_TRACE = 200_000_000
"""Bytes of the trace of one run without its scans; what happens later is told by events and result only."""
_MOST_SCANS = 80_000_000
"""Bytes of the scans of one run when they are read; later ones are not kept."""
_LARGEST_SCAN = 800_000
"""Bytes of all ranges of one step; of larger ones none are kept, as there would be room for a few steps only."""
_LARGEST_MAP = 64_000_000
"""Bytes of a map file; of a larger one no copy is kept."""
_BETWEEN_PRUNING = 16_000_000


class Recorder:
    """The run of one simulation.

    Args:
        simulation: One world, at its start.
        horizon: Steps at most.
        scenario: Its file as the user named it, None for a text.
        options: What else decides how it goes, as JSON has it.
        folder: Write here, into a new or empty folder that is never let go; by default into ``.irsim/runs`` of the
            current directory.

    Attributes:
        folder: Where it is written.
        run_id: Name of that folder.

    Raises:
        RunError: The folder holds something already, or leads elsewhere.
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
        self._runs = None if folder is not None else runs_place(make=True)
        if self._runs is not None:
            tidy(self._runs)
            self.folder = made_folder(self._runs, "scenario" if scenario is None else _stem(scenario))
        else:
            assert folder is not None
            self.folder = str(_new(folder))
        self.run_id = os.path.basename(self.folder)
        self._claim: Claim | None = None
        self._scan = 4 * simulation.world.beams_per_world  # bytes of all ranges of one step
        self._scans = scans = 0 < self._scan <= _LARGEST_SCAN
        self._scan_rows = _MOST_SCANS // self._scan if scans else 0  # that may still come
        self._revision = simulation.revision
        self._log, self._movers = _log_of(simulation, scans)
        self._log.attach(simulation.state)
        self._log.add(simulation.state)
        simulation.log = self._log
        self._pieces = self._events = self._bytes = self._scan_bytes = self._pruned_at = 0
        self._done = False
        self._due = time.monotonic() + _PERIOD
        kept, source = sensors(simulation) if scans else [], simulation.scenario.source
        self._meta: dict[str, Any] = {
            "id": self.run_id,
            "cancelled": False,
            "created": time.strftime("%Y-%m-%dT%H:%M:%S+00:00", time.gmtime()),
            "scenario": scenario,
            "folder": None if source is None else os.path.dirname(os.path.abspath(source)),
            "seed": int(simulation.key()[0]),
            "horizon": horizon,
            "step_time": float(simulation.scenario.world.step_time),
            "options": dict(options),
            "names": [record.name for record in simulation.scenario.objects],
            "sensors": [[key, beams.stop - beams.start] for key, beams in kept],
            "scans": scans or not self._scan,
            "trace_until": None,
            "scans_until": None,
            **_versions(),
        }
        try:
            self._claim = claim(self._path(BEGUN), _text_of(simulation).encode())
            begun(self._path("resolved.json"), plain_scenario(simulation))
            self._meta["maps"] = self._kept_maps()
            self._write_meta()
        except BaseException:
            self._stop()
            if self._runs is not None:
                remove(Path(self.folder))
            raise

    def _kept_maps(self) -> list[list[str]]:
        """Copies of the files that the map was read from: somebody may draw another before the run is looked at."""
        kept = list[list[str]]()
        for name, path in self._simulation.scenario.map_files.items():
            ending = os.path.splitext(path)[1]
            file = f"map-{len(kept)}{ending if ending[1:].isalnum() and len(ending) < 11 else ''}"
            try:
                if os.path.getsize(path) > _LARGEST_MAP:
                    continue
                content = Path(path).read_bytes()
            except OSError as error:
                raise RunError("file-access", f"'{path}' cannot be read: {error.strerror or error}") from None
            begun(self._path(file), content)
            kept.append([name, file])
        return kept

    def advance(self, steps: int, *, until_done: bool = False) -> int:
        """Let time pass like :meth:`irsim.simulation.simulation.Simulation.advance`, and keep what happens."""
        done = 0
        while done < steps:
            some = min(steps - done, self._most_steps())
            more = self._simulation.advance(some, until_done=until_done)
            done += more
            self.look()
            if more < some:
                break
        return done

    def _most_steps(self) -> int:
        """Steps until the next look at the latest: pieces stay small, and scans end at the same step every time."""
        if not self._scans:
            return 2**62
        return max(1, min(_PIECE // self._scan, self._scan_rows - self._log.rows))

    def look(self) -> None:
        """Write a piece if it is time to: to be called now and then, best after every step."""
        if self._simulation.revision != self._revision:
            raise RunError("unreadable-run", "objects came or went: only runs with the same objects are recorded")
        if self._scans and self._log.rows >= self._scan_rows:
            self._end_scans()
        elif self._log.bytes >= _PIECE or time.monotonic() >= self._due:
            self._flush()

    def finish(self, result: RunResult) -> None:
        """Write what is left and the result, which is told where its record is; the run is complete."""
        self._flush()
        result.notes = lacking(self._meta, result.steps)
        result.run_id = self.run_id
        result.artifacts = {name: self._path(name) for name in FILES}
        self._write(RESULT, to_json(result, indent=1))
        used(self.folder)
        self._stop()

    def close(self, *, cancelled: bool = False) -> None:
        """End without a result, unless there is one: what happened so far is kept."""
        if self._done:
            return
        try:
            self._flush()
            if cancelled:
                self._write_meta(cancelled=True)
            used(self.folder)
        finally:
            self._stop()

    def _stop(self) -> None:
        self._done = True
        self._detach()
        if self._claim is not None:
            self._claim.release()

    def _end_scans(self) -> None:
        """Go on without scans."""
        last = self._log.first + self._log.rows - 1
        self._flush()
        self._scans = False
        if self._simulation.log is None:
            return
        self._detach()
        self._log, _ = _log_of(self._simulation, scans=False)
        self._log.attach(self._simulation.state)
        self._simulation.log = self._log
        self._write_meta(scans_until=last)

    def _detach(self) -> None:
        self._simulation.log = None
        self._log.detach(self._simulation.state)

    def _flush(self) -> None:
        """Write what is held: how everybody moved and what happened, or only that where no trace is kept any more."""
        events = self._simulation.state.events(0, self._events)
        self._events += len(events)
        names, step_time = self._simulation.names, self._meta["step_time"]
        told = [_told(event, names, step_time) for event in events]
        log, number = self._log, f"{self._pieces:04d}"
        if log.rows or events:
            self._pieces += 1
        if log.rows:
            movers, pose = self._movers, self._simulation.pose
            self._write(f"trace-{number}.npz", *chunk_of(log, movers, pose, told))
            self._bytes += log.bytes
            self._scan_bytes += 4 * log.ranges.size
            self._scan_rows -= log.rows
            last = log.first + log.rows - 1
            log.clear()
            if self._bytes - self._scan_bytes >= _MOST_TRACE:
                self._scans = False
                self._detach()
                self._write_meta(trace_until=last)
        elif events:
            self._write(f"events-{number}.json", to_json(told))
        self._due = time.monotonic() + _PERIOD
        if self._runs is not None and self._bytes - self._pruned_at > _BETWEEN_PRUNING:
            self._pruned_at = self._bytes
            prune(Path(self._runs), keep=self.run_id)

    def _write_meta(self, **changes: Any) -> None:
        self._meta.update(changes)
        self._write(META, to_json(self._meta, indent=1))

    def _write(self, name: str, *parts: Buffer) -> None:
        written(self._path(name), *parts)

    def _path(self, name: str) -> str:
        return f"{self.folder}{os.sep}{name}"


@contextmanager
def recording(
    env: Env, path: str | Path | None, record: bool | str | Path, *, horizon: int, options: Mapping[str, Any]
) -> Iterator[Recorder | None]:
    """A recorder for the episode of an environment, None if it is not to be recorded; closed whatever happens.

    Args:
        env: At its start.
        path: Scenario file, None for a text.
        record: Whether, or where to.
        horizon: Steps at most.
        options: What else decides how it goes: ``strict``, ``imports``, and ``behavior`` if the robots' was replaced.
    """
    if record is False:
        yield None
        return
    recorder = Recorder(
        env.simulation,
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


def _log_of(simulation: Simulation, scans: bool) -> tuple[core.Log, list[int]]:
    """A log of what can move: everybody where Python takes part."""
    records, everybody = simulation.scenario.objects, simulation.in_python
    movers = [row for row, record in enumerate(records) if everybody or not record.static]
    columns = max((records[row].vel_dim for row in movers), default=0)
    return core.Log(simulation.world, movers, min(3, columns), scans), movers


def _told(event: tuple[Any, ...], names: Mapping[int, str], step_time: float) -> dict[str, Any]:
    """What :func:`irsim.simulation.events.read_events` makes of it, as JSON has it."""
    kind, step, first, second, x, y = event
    partner = names[second] if second >= 0 else None
    time = step * step_time
    return {"kind": kind, "time": time, "step": step, "object": names[first], "partner": partner, "x": x, "y": y}


def _stem(scenario: str) -> str:
    return os.path.splitext(os.path.basename(scenario))[0]


def _new(folder: Path) -> Path:
    """A folder that is there and empty."""
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise RunError("file-exists", f"'{folder}' exists and is not empty", "name another folder for the run")
    folder.mkdir(parents=True, exist_ok=True)
    return folder.resolve()


def _text_of(simulation: Simulation) -> str:
    """The scenario as given."""
    scenario = simulation.scenario
    return scenario.text if scenario.text is not None else json.dumps(scenario.document, default=str)


def _versions() -> dict[str, str]:
    from irsim.common.version import version

    return {
        "irsim": version(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "platform": platform.platform(),
    }
