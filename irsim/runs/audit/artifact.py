"""Reads a recorded run for an audit: plain arrays and facts, without any code of the engine or of scenarios."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field, ValidationError

from irsim.common.archives import opened_archive, read_array
from irsim.common.arrays import Floats
from irsim.common.hashing import digest
from irsim.common.records import ContentError, read_bytes, read_json
from irsim.runs.audit.record import Drawn, EventFacts, Meta, ObjectFacts, Options, ResultFacts, WorldFacts
from irsim.runs.cells import CELLS_FILE, unpack_cells
from irsim.runs.files import DIGEST_LENGTH, RunError, json_of, plain_file, text_of, unreadable
from irsim.runs.store import META, RESULT, find_run

__all__ = ["Artifact", "Body", "read_artifact"]

_PIECE = re.compile(r"(trace|events)-(\d{4,9})\.(npz|json)")
_MAX_PIECE_BYTES = 256 * 1024**2
_MAX_NUMBERS = 2**27
"""Number of values of all poses that are read."""
_MAX_CORNERS = 2_000_000
_MAX_EVENTS = 2_000_000
_MAX_LENGTH_M = 1e12
_ARRAYS = ("pose", "control", "pose_at", "goal", "flags")


@dataclass(frozen=True)
class Body:
    """An object of a run, as it was built.

    Attributes:
        facts: Its own facts: name, goals, outline.
        options: Facts that it may share with others: drive, limits of arrival, what may be passed.
        drawn: Outline and limits, which the seed may have decided.
    """

    facts: ObjectFacts
    options: Options
    drawn: Drawn

    @property
    def name(self) -> str:
        """Its name."""
        return self.facts.name

    @property
    def drive(self) -> str | None:
        """Name of its drive, None without one."""
        name = (self.options.kinematics or {}).get("name")
        return name if isinstance(name, str) else None

    @property
    def is_robot(self) -> bool:
        """Whether it is a robot."""
        return self.options.role == "robot"

    @property
    def replays(self) -> bool:
        """Whether it follows a recording."""
        moved_by = self.options.group_behavior or self.options.behavior or {}
        return moved_by.get("name") == "replay"

    @property
    def estimates(self) -> bool:
        """Whether it decides from an estimate of its pose, so that it passes waypoints where it believes them to be."""
        return self.options.perceives in ("estimate", "both")

    @property
    def endless(self) -> bool:
        """Whether it has no last goal."""
        return self.options.loop or self.options.wander


@dataclass(frozen=True)
class Artifact:
    """A recorded run.

    Attributes:
        folder: Its folder.
        meta: Facts of ``run.json``.
        world: Facts of the world.
        bodies: The N objects.
        first: Step of the first row.
        pose: (T, N, 3) x, y [m], heading [rad], world frame; NaN while an object is not in the world.
        control: (T, N, 3) executed controls, in single precision.
        goal: (T, N, 3) present goals; NaN without one.
        arrived, collided, stopped: (T, N) flags.
        believes: (T, N) whether one that goes by an estimate believes to have arrived.
        at_rest: (T, N) whether it has stopped or arrived; of one that goes by an estimate, whether it believes so.
        estimate: Row of an object that goes by an estimate -> (T, 3) pose that its sensor reported, NaN without one;
            without objects whose readings are not in the record.
        events: The events, in order.
        result: Facts of ``result.json``, None if the run has not ended.
        cells: Occupied cells of the map, its corner and the extent of a cell; None without a map.
    """

    folder: Path
    meta: Meta
    world: WorldFacts
    bodies: Sequence[Body]
    first: int
    pose: Floats
    control: Floats
    goal: Floats
    arrived: NDArray[np.bool_]
    collided: NDArray[np.bool_]
    stopped: NDArray[np.bool_]
    believes: NDArray[np.bool_]
    at_rest: NDArray[np.bool_]
    estimate: Mapping[int, Floats]
    events: Sequence[EventFacts]
    result: ResultFacts | None
    cells: tuple[NDArray[np.bool_], Floats, Floats] | None

    @property
    def id(self) -> str:
        """Name of its folder."""
        return self.folder.name

    @property
    def names(self) -> list[str]:
        """Names of the objects."""
        return [body.name for body in self.bodies]

    @property
    def last(self) -> int:
        """Step of the last row."""
        return self.first + len(self.pose) - 1

    @property
    def step_time(self) -> float:
        """Period [s]."""
        return self.meta.step_time

    def settles(self, body: Body) -> bool:
        """Whether an object that has arrived stays so: a robot with a last goal, where the world says so."""
        return self.world.after_arrival is not None and body.is_robot and not body.endless


def read_artifact(run: str | Path) -> Artifact:
    """Read a recorded run.

    Args:
        run: Id of the run, its folder, one of its files, or ``last``.

    Raises:
        RunError: There is no such run, a file of it is damaged, or it was recorded without what an audit needs.
    """
    path = Path(run)
    folder = path.parent if path.is_file() and (path.parent / META).is_file() else find_run(run)
    meta = _parsed(Meta, json_of(folder, META), folder, META)
    text = text_of(folder, "resolved.json")
    if text is None or (meta.resolved is not None and digest(text)[:DIGEST_LENGTH] != meta.resolved):
        raise unreadable(f"resolved.json of run {folder.name} is missing or has been changed")
    data = json_of(folder, "resolved.json")
    world, bodies = _bodies(data, meta, folder)
    pieces = _pieces(folder)
    numbers = sum(count for _, _, count in meta.gauges)
    traces = [_read_piece(folder / name, len(bodies), numbers) for name in pieces if name.startswith("trace")]
    if not traces:
        raise unreadable(f"run {folder.name} has no recorded steps")
    if sum(trace["pose"].size for trace in traces) > _MAX_NUMBERS:
        raise RunError("file-too-large", f"run {folder.name} has more steps and objects than an audit reads")
    following = traces[0]["first"]
    for trace in traces:
        if trace["first"] != following:
            raise unreadable(f"the pieces of run {folder.name} do not follow each other: they have been changed")
        following += len(trace["pose"])
    flags = np.concatenate([trace["flags"] for trace in traces])
    return Artifact(
        folder=folder,
        meta=meta,
        world=world,
        bodies=bodies,
        first=traces[0]["first"],
        pose=np.concatenate([trace["pose"] for trace in traces]),
        control=np.concatenate([trace["control"] for trace in traces]),
        goal=np.concatenate([trace["goal"] for trace in traces]),
        arrived=(flags & 1) != 0,
        collided=(flags & 2) != 0,
        stopped=(flags & 4) != 0,
        believes=(flags & 8) != 0,
        at_rest=(flags & (4 | np.where([body.estimates for body in bodies], 8, 1))) != 0,
        estimate=_estimates(meta, bodies, [trace["readings"] for trace in traces]),
        events=_events(folder, pieces),
        result=_result(folder),
        cells=_cells(folder, meta),
    )


def _estimates(meta: Meta, bodies: Sequence[Body], readings: Sequence[Floats | None]) -> dict[int, Floats]:
    """The reported poses of objects that go by an estimate: of their localization, else of their odometry."""
    parts = [part for part in readings if part is not None]
    if len(parts) < len(readings):
        return {}
    begins = dict[str, int]()
    first = 0
    for key, columns, count in meta.gauges:
        if columns[:3] == ["x", "y", "theta"] and count >= 3:
            begins[key] = first
        first += count
    estimates = {}
    for row, body in enumerate(bodies):
        keys = [key for kind in ("localization", "odometry") if (key := f"{body.name}/{kind}") in begins]
        if body.estimates and keys:
            begin = begins[keys[0]]
            estimates[row] = np.concatenate([part[:, begin : begin + 3] for part in parts])
    return estimates


def _parsed(model: Any, data: Any, folder: Path, name: str) -> Any:
    try:
        return model.model_validate(data)
    except ValidationError:
        what = f"'{name}' of run {folder.name} has been changed: it has other keys or values than irsim writes"
        raise unreadable(what) from None


def _result(folder: Path) -> ResultFacts | None:
    data = json_of(folder, RESULT)
    return None if data is None else _parsed(ResultFacts, data, folder, RESULT)


def _bodies(data: Any, meta: Meta, folder: Path) -> tuple[WorldFacts, list[Body]]:
    name = "resolved.json"
    if not isinstance(data, dict) or not all(isinstance(data.get(key), list) for key in ("objects", "options")):
        raise unreadable(f"'{name}' of run {folder.name} has been changed: it has no objects")
    built = data.get("built")
    if not isinstance(built, dict):
        raise RunError(
            "record-incomplete",
            f"run {folder.name} was recorded without the outlines and limits of its objects (irsim {meta.irsim})",
            "record it again with this version: the same scenario and seed",
        )
    world = _parsed(WorldFacts, data.get("world"), folder, name)
    options = [_parsed(Options, item, folder, name) for item in data["options"]]
    bodies, corners = list[Body](), 0
    for row, item in enumerate(data["objects"]):
        facts = _parsed(ObjectFacts, item, folder, name)
        drawn = _parsed(Drawn, _row(built, row), folder, name)
        corners += sum(len(part.vertices) for part in drawn.outlines)
        if not 0 <= facts.options < len(options):
            raise unreadable(f"'{name}' of run {folder.name} has been changed: see its key 'objects.{row}.options'")
        bodies.append(Body(facts, options[facts.options], drawn))
    if [body.name for body in bodies] != meta.names or corners > _MAX_CORNERS or len(set(meta.names)) < len(bodies):
        raise unreadable(f"'{name}' of run {folder.name} has been changed: run.json has other objects")
    return world, bodies


def _row(built: dict[str, Any], row: int) -> dict[str, Any]:
    """The values of one object."""
    return {key: values[row] for key, values in built.items() if isinstance(values, list) and row < len(values)}


def _pieces(folder: Path) -> list[str]:
    """Names of the pieces, in the order of their numbers."""
    try:
        names = os.listdir(folder)
    except OSError:
        raise RunError("unknown-run", f"run {folder.name} has been deleted") from None
    pieces = sorted((int(match[2]), name) for name in names if (match := _PIECE.fullmatch(name)))
    for number, (there, name) in enumerate(pieces):
        if there != number or plain_file(folder, name) is None:
            raise unreadable(f"piece {number:04d} of run {folder.name} is missing, exists twice, or is not a file")
    return [name for _, name in pieces]


def _read_piece(path: Path, count: int, numbers: int) -> dict[str, Any]:
    try:
        with opened_archive(path, most_bytes=_MAX_PIECE_BYTES, most_entries=16, packed=False) as archive:
            about = _About.model_validate(read_json(archive.read("piece.json"), most_bytes=_MAX_PIECE_BYTES))
            names = [*_ARRAYS, *(["readings"] if about.reading_rows else [])]
            arrays = {name: read_array(archive, archive.getinfo(f"{name}.npy"), ("f8", "f4", "u1")) for name in names}
        return _rows(about, arrays, count, numbers)
    except (ContentError, ValidationError, ValueError, KeyError, IndexError, OSError) as error:
        odd = isinstance(error, ValidationError)
        what = "piece.json has other keys or values than irsim writes" if odd else str(error)[:200]
        raise unreadable(f"'{path.name}' of run {path.parent.name} has been changed: {what}") from None


class _About(BaseModel):
    """``piece.json``."""

    first: Annotated[int, Field(ge=0, lt=2**62)]
    rows: Annotated[int, Field(gt=0, lt=2**31)]
    movers: list[int]
    goal_rows: list[int]
    flag_rows: list[int]
    reading_rows: list[int] = []
    events: list[EventFacts] = []


def _rows(about: _About, arrays: dict[str, NDArray[Any]], count: int, numbers: int) -> dict[str, Any]:
    """The rows of a piece, of all objects."""
    rows, movers = about.rows, about.movers
    if rows * max(1, count, numbers) * 3 > _MAX_NUMBERS or (movers and not 0 <= min(movers) <= max(movers) < count):
        raise ValueError("it has more rows or objects than the run")
    for name in ("pose", "control", "pose_at", "goal"):
        values = arrays[name]
        if values.dtype.kind != "f" or (np.isfinite(values) & (np.abs(values) > _MAX_LENGTH_M)).any():
            raise ValueError(f"its array {name} has numbers that irsim does not write")
    columns = arrays["control"].shape[-1] if arrays["control"].ndim == 3 else 4
    shapes = {"pose": (rows, len(movers), 3), "control": (rows, len(movers), columns), "pose_at": (count, 3)}
    if columns > 3 or any(arrays[name].shape != shape for name, shape in shapes.items()):
        raise ValueError("its arrays do not fit the run")
    pose = np.repeat(arrays["pose_at"][None], rows, axis=0)
    pose[:, movers] = arrays["pose"]
    control = np.zeros((rows, count, 3))
    control[:, movers, :columns] = arrays["control"]
    readings = None
    if about.reading_rows:
        readings = _expanded(about.reading_rows, arrays["readings"], rows, (numbers,)).astype(np.float64)
    return {
        "readings": readings,
        "first": about.first,
        "pose": pose.astype(np.float64),
        "control": control,
        "goal": _expanded(about.goal_rows, arrays["goal"], rows, (count, 3)),
        "flags": _expanded(about.flag_rows, arrays["flags"], rows, (count,)).astype(np.uint8),
    }


def _expanded(begins: Sequence[int], values: NDArray[Any], rows: int, shape: tuple[int, ...]) -> NDArray[Any]:
    """(T, …) one row per step, of values that each hold from their row on."""
    lengths = np.diff([*begins, rows])
    if values.shape != (len(begins), *shape) or (len(begins) and (begins[0] != 0 or (lengths <= 0).any())):
        raise ValueError("its rows are out of order")
    if not len(begins):
        if 0 not in shape:
            raise ValueError("it has no goals or flags")
        return np.zeros((rows, *shape))
    return np.repeat(values, lengths, axis=0)


def _events(folder: Path, pieces: Sequence[str]) -> list[EventFacts]:
    events = list[EventFacts]()
    for name in pieces:
        if name.startswith("events"):
            data = json_of(folder, name)
            events += _parsed(_EventList, {"events": data}, folder, name).events
        else:
            with opened_archive(folder / name, most_bytes=_MAX_PIECE_BYTES, most_entries=16, packed=False) as archive:
                events += _About.model_validate(read_json(archive.read("piece.json"))).events
        if len(events) > _MAX_EVENTS:
            raise RunError("file-too-large", f"run {folder.name} has more events than an audit reads")
    return events


class _EventList(BaseModel):
    events: list[EventFacts]


def _cells(folder: Path, meta: Meta) -> tuple[NDArray[np.bool_], Floats, Floats] | None:
    if meta.cells is None:
        return None
    path = plain_file(folder, CELLS_FILE)
    try:
        content = b"" if path is None else read_bytes(path, 128 * 1024**2)
        if digest(content)[:DIGEST_LENGTH] != meta.cells:
            raise ContentError("it is missing or is not the one of run.json")
        return unpack_cells(content)
    except ContentError as error:
        raise unreadable(f"'{CELLS_FILE}' of run {folder.name} has been changed: {error.message}") from None
