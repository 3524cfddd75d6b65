"""Read recorded runs, also while they are being written, or after they were interrupted."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, Field, ValidationError

from irsim.common.hashing import digest
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import format_path, nearest
from irsim.results.run import RunResult
from irsim.runs.chunks import Layout, load_chunk, load_events
from irsim.runs.files import DIGEST_LENGTH, RunError, json_of, plain_file, text_of, unreadable
from irsim.runs.plain_scenario import with_options
from irsim.runs.store import META, RESULT, Status, find_run, omission_notes, run_folders, runs_folder, status_of
from irsim.scenario.messages.translate import option_problems
from irsim.simulation.events import Event
from irsim.simulation.trace import Trace, cut_trace, join_traces

__all__ = ["Run", "list_runs", "open_run"]

Name = Annotated[str, Field(max_length=4096)]
Count = Annotated[int, Field(strict=True, ge=0, lt=2**62)]
Flag = Annotated[bool, Field(strict=True)]


class _Meta(BaseModel):
    """The keys that ``run.json`` must have, and the types of its optional keys."""

    names: list[Name]
    sensors: list[tuple[Name, Annotated[int, Field(strict=True, gt=0, le=10**7)]]]
    gauges: list[tuple[Name, list[Name], Annotated[int, Field(strict=True, gt=0, le=10**7)]]] = []
    step_time: Annotated[float, Field(strict=True, gt=0, le=1e9, allow_inf_nan=False)]
    seed: Annotated[int, Field(strict=True, ge=0, lt=2**128)]
    id: Name = ""
    created: Name = ""
    scenario: Name | None = None
    folder: Name | None = None
    horizon: Count = 0
    options: dict[str, Any] = {}
    maps: list[tuple[Name, Name]] = []
    scans: Flag = True
    trace_until: Count | None = None
    scans_until: Count | None = None
    resolved: Name | None = None
    cancelled: Flag = False
    irsim: Name = ""


_PIECE = re.compile(r"(trace|events)-(\d{4,})\.(npz|json)")


@dataclass(frozen=True)
class Run:
    """One recorded run.

    Attributes:
        folder: Folder of the run.
        meta: Content of ``run.json``: id, created, seed, scenario, options, horizon, versions, names of the objects …
    """

    folder: Path
    meta: dict[str, Any]

    @property
    def id(self) -> str:
        """Id of the run, the name of its folder."""
        return self.folder.name

    @property
    def status(self) -> Status:
        """``running``, ``finished``, ``cancelled``, or ``interrupted``: without a result, and no longer written."""
        return status_of(self.folder)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the objects, in order."""
        return tuple(str(name) for name in self.meta["names"])

    @property
    def options(self) -> dict[str, Any]:
        """Other options of the run: ``strict``, ``imports``, ``behavior``, ``perturb``."""
        options = self.meta.get("options")
        return options if isinstance(options, dict) else {}

    def index_of(self, name: str) -> int:
        """Index of the object with a name.

        Raises:
            RunError: No object has that name; the message suggests a similar name, or lists some.
        """
        if name in self.names:
            return self.names.index(name)
        near = nearest(name, self.names)
        some = ", ".join(clean(other, 40) for other in self.names[:5])
        fix = (
            f"did you mean {clean(near, 40)!r}?" if near else f"the objects are {some}" + ", …" * (len(self.names) > 5)
        )
        raise RunError("bad-argument", f"run {self.id} has no object {clean(name)!r}", fix, where="robot")

    @property
    def step_time(self) -> float:
        """Period [s]."""
        return float(self.meta["step_time"])

    @cached_property
    def scenario_text(self) -> str:
        """The scenario as the user wrote it."""
        text = text_of(self.folder, "scenario.yaml")
        if text is None or not text.strip():
            raise unreadable(f"run {self.id} has no scenario.yaml, or an empty one")
        return text

    @cached_property
    def events(self) -> list[Event]:
        """The events in order; in an interrupted run they end with its trace."""
        try:
            events = [Event(**item) for name in self._pieces("trace", "events") for item in self._events_in(name)]
        except TypeError as error:
            raise unreadable(f"the events of run {self.id} have been changed: {error}") from None
        if self.result is not None:
            return events
        last = self.last_step
        return [event for event in events if event.step <= last]

    @cached_property
    def result(self) -> RunResult | None:
        """The result; None if the run has not ended."""
        text = text_of(self.folder, RESULT)
        if text is None:
            return None
        try:
            return RunResult.model_validate_json(text)
        except ValueError:
            raise unreadable(f"result.json of run {self.id} has been changed") from None

    @cached_property
    def resolved(self) -> dict[str, Any]:
        """World and objects at the start, with all defaults, as plain data."""
        text, known = text_of(self.folder, "resolved.json"), self.meta.get("resolved")
        try:
            if text is not None and known in (None, digest(text)[:DIGEST_LENGTH]):
                return with_options(json_of(self.folder, "resolved.json"))
        except (TypeError, LookupError):
            pass
        raise unreadable(f"resolved.json of run {self.id} is missing or has been changed")

    @property
    def notes(self) -> list[str]:
        """Notes on what was too large to be recorded, and of a finished run the messages of its bridges."""
        result = self.result
        omissions = omission_notes(self.meta, None if result is None else result.steps)
        return [*omissions, *(note for note in ([] if result is None else result.notes) if note not in omissions)]

    @property
    def extent(self) -> str:
        """Which steps were recorded, and why no more, as a message."""
        why = [note for note in self.notes if note.startswith("recorded")]
        return "; ".join([f"it has the steps 0 to {self.last_step}", *why])

    @property
    def last_step(self) -> int:
        """Step of the last row of the trace; -1 without any."""
        pieces = self._pieces("trace")
        return int(self._piece(pieces[-1], [], scans=False).step[-1]) if pieces else -1

    def trace(self) -> Trace:
        """The recorded trace; in an interrupted run it ends with its last piece.

        Raises:
            RunError: No step has been recorded, or a file has been changed.
        """
        pieces = [self._piece(name) for name in self._pieces("trace")]
        if not pieces:
            raise self.no_steps()
        trace = join_traces(pieces)
        if (np.diff(trace.step) != 1).any():
            raise unreadable(f"the pieces of run {self.id} do not follow each other: they have been changed")
        return trace

    def blocks(self, rows: int, objects: Sequence[int] | None = None, *, scans: bool = True) -> Iterator[Trace]:
        """Yield the recorded trace in blocks, of which only one is in memory at a time.

        Args:
            rows: Number of rows of each block; the last one may have fewer.
            objects: Indices of the objects that the blocks are to have, with their scans; default: all.
            scans: Whether the blocks are to have scans.

        Raises:
            RunError: No step has been recorded, or a file has been changed.
        """
        parts, count, following = list[Trace](), 0, None
        for name in self._pieces("trace"):
            piece = self._piece(name, objects, scans)
            if following not in (None, int(piece.step[0])):
                raise unreadable(f"the pieces of run {self.id} do not follow each other: they have been changed")
            following = int(piece.step[-1]) + 1
            while len(piece):
                parts.append(cut_trace(piece, slice(rows - count)))
                piece = cut_trace(piece, slice(rows - count, None))
                count += len(parts[-1])
                if count == rows:
                    yield join_traces(parts)
                    parts, count = [], 0
        if parts:
            yield join_traces(parts)
        elif following is None:
            raise self.no_steps()

    def no_steps(self) -> RunError:
        """The error of a run without a trace."""
        if self.status == "finished":
            return unreadable(f"the trace of run {self.id} is missing")
        return unreadable(f"run {self.id} was interrupted before its first step was recorded")

    def files(self) -> list[str]:
        """Names of the files of the run."""
        return sorted(name for name in self._names() if plain_file(self.folder, name))

    def _names(self) -> list[str]:
        try:
            return os.listdir(self.folder)
        except OSError:
            raise RunError("unknown-run", f"run {self.id} has been deleted") from None

    def _pieces(self, *kinds: str) -> list[str]:
        """Names of the pieces of some kinds, in the order of their numbers.

        Raises:
            RunError: A piece is missing.
        """
        pieces = sorted((int(m[2]), m[1], m[0]) for name in self._names() if (m := _PIECE.fullmatch(name)))
        for number, (there, _, _) in enumerate(pieces):
            if there != number:
                raise unreadable(f"piece {number:04d} of run {self.id} is missing, or exists twice")
        return [name for _, kind, name in pieces if kind in kinds]

    def _piece(self, name: str, objects: Sequence[int] | None = None, scans: bool = True) -> Trace:
        sensors = [(str(key), int(beams)) for key, beams in self.meta["sensors"]]
        gauges = [
            (str(key), [str(one) for one in names], int(count)) for key, names, count in self.meta.get("gauges", ())
        ]
        layout = Layout(self.names, sensors, self.step_time, gauges)
        return load_chunk(self._path(name), layout, objects, scans=scans)

    def _events_in(self, name: str) -> Any:
        """Events in a piece of the trace, or in a file of events."""
        return load_events(self._path(name)) if name.startswith("trace") else json_of(self.folder, name)

    def _path(self, name: str) -> Path:
        path = plain_file(self.folder, name)
        if path is None:
            raise unreadable(f"'{name}' of run {self.id} is not an ordinary file")
        return path


def open_run(folder_or_id: str | Path, workspace: str | Path | None = None) -> Run:
    """Open a recorded run.

    Args:
        folder_or_id: Id of the run, its folder, or ``last`` for the run started last.
        workspace: Folder whose ``.irsim/runs`` holds the run; default: the current directory.

    Raises:
        RunError: There is no such run, or it cannot be read.
    """
    folder = find_run(folder_or_id, workspace)
    meta = json_of(folder, META)
    if not isinstance(meta, dict):
        raise unreadable(f"run.json of run {folder.name} has been changed: it is not a mapping")
    try:
        _Meta.model_validate(meta)
    except ValidationError as error:
        key = format_path(option_problems(error, meta, _Meta)[0].path)
        raise unreadable(f"run.json of run {folder.name} has been changed: see its key '{clean(key)}'") from None
    return Run(folder, meta)


def list_runs(workspace: str | Path | None = None) -> list[Run]:
    """The runs of a workspace, the one started last first; runs that cannot be read are skipped."""
    runs = []
    for folder in run_folders(runs_folder(workspace)):
        try:
            meta = json_of(folder, META)
        except (RunError, OSError):
            continue
        with suppress(ValidationError):
            _Meta.model_validate(meta)
            runs.append(Run(folder, meta))
    return runs
