"""Scenes, states and feedback as JSON, and series of states as NumPy files (NPZ)."""

from __future__ import annotations

import json
import math
import zipfile
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from irsim.bridges.base import BridgeError
from irsim.bridges.scene_checks import MAX_CELLS, check_scene, check_states, read_arrays
from irsim.bridges.state import Feedback, Motion, WorldState
from irsim.common.files import replacing
from irsim.common.outline import BodyPart, Circle, Line, Polygon
from irsim.simulation.scene import SCENE_VERSION, Grid, Lidar, SceneDescription, SceneObject

__all__ = [
    "feedback_as_json",
    "feedback_of",
    "load_scene",
    "load_states",
    "motion_as_json",
    "save_scene",
    "save_states",
    "scene_as_json",
    "scene_of",
    "state_as_json",
    "state_of",
]

_MAX_SCENE_BYTES = 64 * 1024 * 1024
"""Largest file of a scene."""
_MAX_NAMES = 100_000
"""Number of objects that one message may name."""
_NOT_WRITTEN = ("row", "static", "threshold", "look")
"""Fields of objects that files of version 1 do not have."""
_BY_ROW = ("pose", "twist", "control", "goal", "arrived", "collided", "stopped")


# scenes ---------------------------------------------------------------------------------------------------------------
def scene_as_json(scene: SceneDescription) -> dict[str, Any]:
    """A scene as JSON types; infinite numbers are ``null``, and cells of a map are runs of free and solid ones."""
    grid = scene.grid
    found = asdict(replace(scene, grid=None, maps=()))
    del found["maps"]
    for agent, original in zip(found["agents"], scene.agents, strict=True):
        agent["parts"] = [_part_as_json(part) for part in original.parts]
        for key in _NOT_WRITTEN:
            del agent[key]
        for lidar in agent["lidars"]:
            del lidar["between"]
    if grid is not None:
        found["grid"] = {"size": list(grid.occupied.shape), "cell": grid.cell, "origin": grid.origin,
                         "runs": _runs(grid.occupied)}  # fmt: skip
    found["about"] = dict(scene.about)
    return _plain(found)  # type: ignore[no-any-return]


def scene_of(data: Any) -> SceneDescription:
    """The inverse of :func:`scene_as_json`.

    Raises:
        BridgeError: The data are not those of a scene.
    """
    try:
        if data["version"] != SCENE_VERSION:
            raise _unusable(f"it has version {data['version']!r}, this irsim reads {SCENE_VERSION}")
        fields = dict(data)
        fields["agents"] = tuple(_agent(item) for item in data["agents"])
        fields["grid"] = None if data["grid"] is None else _grid(data["grid"])
        fields["low"], fields["high"] = _numbers(data["low"], 2), _numbers(data["high"], 2)
        scene = SceneDescription(**fields)
        check_scene(scene)
        return scene
    except (KeyError, TypeError, ValueError, AttributeError, IndexError, OverflowError) as error:
        if isinstance(error, BridgeError):
            raise
        raise _unusable(f"{type(error).__name__}: {error}") from None


def save_scene(scene: SceneDescription, path: str | Path) -> None:
    """Write a scene to a JSON file."""
    with replacing(Path(path)) as temporary:
        temporary.write_text(json.dumps(scene_as_json(scene)), encoding="utf-8")


def load_scene(path: str | Path) -> SceneDescription:
    """Read a scene from a JSON file.

    Raises:
        BridgeError: The file cannot be read, or is not that of a scene.
    """
    file = Path(path)
    try:
        if file.stat().st_size > _MAX_SCENE_BYTES:
            raise _unusable(f"it is larger than {_MAX_SCENE_BYTES // 2**20} MB")
        data = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        if isinstance(error, BridgeError):
            raise
        raise _unusable(str(error)) from None
    return scene_of(data)


def _unusable(why: str) -> BridgeError:
    return BridgeError(
        "bridge-file", f"this is not a scene of irsim: {why}", "write it again with this version of irsim"
    )


def _part_as_json(part: BodyPart) -> dict[str, Any]:
    if isinstance(part, Circle):
        return {"circle": [*part.center, part.radius]}
    if isinstance(part, Polygon):
        return {"polygon": part.corners.tolist()}
    return {"line": part.points.tolist(), "closed": part.closed}


def _part(data: Mapping[str, Any]) -> BodyPart:
    if "circle" in data:
        x, y, radius = _numbers(data["circle"], 3)
        return Circle((x, y), radius)
    if "polygon" in data:
        return Polygon(_points(data["polygon"]))
    return Line(_points(data["line"]), bool(data["closed"]))


def _agent(data: Mapping[str, Any]) -> SceneObject:
    fields = dict(data)
    fields["parts"] = tuple(_part(item) for item in data["parts"])
    fields["lidars"] = tuple(Lidar(**{**item, "mount": _numbers(item["mount"], 3)}) for item in data["lidars"])
    fields["pose"], fields["color"] = _numbers(data["pose"], 3), _numbers(data["color"], 3)
    fields["goals"] = tuple(_numbers(goal, 3) for goal in data["goals"])
    fields["low"] = tuple(-math.inf if value is None else float(value) for value in data["low"])
    for key in ("high", "acceleration"):
        fields[key] = tuple(math.inf if value is None else float(value) for value in data[key])
    fields["mass"] = math.inf if data["mass"] is None else float(data["mass"])
    return SceneObject(**fields)


def _grid(data: Mapping[str, Any]) -> Grid:
    nx, ny = (int(value) for value in data["size"])
    lengths = np.asarray(data["runs"], dtype=np.int64)
    if nx > MAX_CELLS or ny > MAX_CELLS or nx * ny > MAX_CELLS:
        raise ValueError(f"the map has {nx} x {ny} cells, more than {MAX_CELLS}")
    if nx < 1 or ny < 1 or (lengths < 0).any() or (lengths > nx * ny).any() or int(lengths.sum()) != nx * ny:
        raise ValueError("the runs of the map do not fill its cells")
    flat = np.repeat(np.arange(len(lengths)) % 2 == 1, lengths)
    return Grid(flat.reshape(nx, ny), _numbers(data["cell"], 2), _numbers(data["origin"], 2))


def _runs(occupied: Any) -> list[int]:
    """Lengths of the runs of free and solid cells in turns, beginning with free ones."""
    flat = np.concatenate([[False], np.asarray(occupied, dtype=bool).reshape(-1)])
    changes = np.flatnonzero(flat[1:] != flat[:-1])
    edges = np.concatenate([[0], changes, [len(flat) - 1]])
    found: list[int] = np.diff(edges).tolist()
    return found


def _points(data: Any) -> Any:
    points = np.asarray(data, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise ValueError("points are pairs of finite numbers")
    return points


def _numbers(data: Sequence[Any], count: int) -> Any:
    values = tuple(float(value) for value in data)
    if len(values) != count or not all(map(math.isfinite, values)):
        raise ValueError(f"{count} finite numbers are needed, got {list(data)}")
    return values


def _plain(value: Any) -> Any:
    """JSON types; NaN and infinities become ``null``."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value


# states ---------------------------------------------------------------------------------------------------------------
def state_as_json(state: WorldState) -> dict[str, Any]:
    """A state as JSON types; NaN and infinities are ``null``."""
    found: dict[str, Any] = {"version": SCENE_VERSION, "step": state.step, "time": state.time}
    found |= {key: getattr(state, key) for key in _BY_ROW}
    found |= {"ranges": dict(state.ranges), "paths": dict(state.paths)}
    return _plain(found)  # type: ignore[no-any-return]


def state_of(data: Any) -> WorldState:
    """The inverse of :func:`state_as_json`: ``null`` is NaN, and infinite in ranges.

    Raises:
        BridgeError: The data are not those of a state.
    """
    try:
        if data["version"] != SCENE_VERSION:
            raise ValueError(f"it has version {data['version']!r}, this irsim reads {SCENE_VERSION}")
        kinds = {"arrived": np.bool_, "collided": np.bool_, "stopped": np.bool_}
        arrays: dict[str, Any] = {key: _rows(data[key], kinds.get(key, np.float64)) for key in _BY_ROW}
        arrays |= {"step": np.array([data["step"]], dtype=np.int64), "time": np.array([data["time"]], dtype=np.float64)}
        scans = {f"ranges:{key}": _rows(row, np.float32, math.inf) for key, row in data["ranges"].items()}
        paths = {key: np.asarray(_rows(row, np.float64)[0]) for key, row in data["paths"].items()}
        check_states(arrays | scans)
    except (KeyError, TypeError, ValueError, AttributeError, IndexError, OverflowError) as error:
        raise BridgeError("bridge-file", f"this is not a state of irsim: {error}", "write it again") from None
    return replace(_states(arrays | scans)[0], paths=paths)


def _rows(data: Any, kind: Any, missing: float = math.nan) -> Any:
    """(1, ...) an array of JSON types, whose ``null`` is a number."""
    array = np.array(data, dtype=object)
    array[np.frompyfunc(lambda value: value is None, 1, 1)(array).astype(bool)] = missing
    with np.errstate(over="ignore"):
        return array[None].astype(kind)


def motion_as_json(motion: Motion) -> dict[str, Any]:
    """The middle of a step as JSON types."""
    return _plain({"version": SCENE_VERSION, **asdict(motion)})  # type: ignore[no-any-return]


def save_states(states: Iterable[WorldState], path: str | Path) -> None:
    """Write successive states to an NPZ file; paths are left out.

    Raises:
        BridgeError: There are no states.
    """
    kept = list(states)
    if not kept:
        raise BridgeError("bridge-mismatch", "there are no states to write", "give at least one")
    arrays: dict[str, Any] = {key: np.stack([getattr(state, key) for state in kept]) for key in _BY_ROW}
    arrays["step"] = np.array([state.step for state in kept], dtype=np.int64)
    arrays["time"] = np.array([state.time for state in kept])
    for key in kept[0].ranges:
        arrays[f"ranges:{key}"] = np.stack([state.ranges[key] for state in kept])
    with replacing(Path(path)) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, version=np.int64(SCENE_VERSION), **arrays)


def load_states(path: str | Path) -> list[WorldState]:
    """Read the states of an NPZ file.

    Raises:
        BridgeError: The file cannot be read, or is not one of states.
    """
    try:
        data = read_arrays(Path(path))
        version = int(data.pop("version"))
        if version != SCENE_VERSION:
            raise ValueError(f"it has version {version}, this irsim reads {SCENE_VERSION}")
        check_states(data)
    except _NOT_STATES as error:
        why = f"{error} is missing" if isinstance(error, KeyError) else error
        raise BridgeError("bridge-file", f"this is not a file of states: {why}", "write it again") from None
    return _states(data)


_NOT_STATES = (
    OSError, ValueError, KeyError, TypeError, IndexError, EOFError, NotImplementedError, RuntimeError,
    zipfile.BadZipFile, zlib.error,
)  # fmt: skip


def _states(data: Mapping[str, Any]) -> list[WorldState]:
    scans = {key.removeprefix("ranges:"): value for key, value in data.items() if key.startswith("ranges:")}
    return [
        WorldState(
            int(step),
            float(time),
            **{key: data[key][row] for key in _BY_ROW},
            ranges={key: value[row] for key, value in scans.items()},
        )
        for row, (step, time) in enumerate(zip(data["step"], data["time"], strict=True))
    ]


# feedback -------------------------------------------------------------------------------------------------------------
def _is_finite(values: list[float]) -> list[float]:
    if not all(math.isfinite(value) for value in values):
        raise ValueError("numbers must be finite")
    return values


_Three = Annotated[list[float], Field(min_length=3, max_length=3), AfterValidator(_is_finite)]
_Named = Annotated[dict[str, _Three], Field(max_length=_MAX_NAMES)]


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid")

    version: Literal[1] = 1
    poses: _Named = {}
    twists: _Named = {}
    commands: _Named = {}
    goals: _Named = {}
    starts: _Named = {}
    ranges: Annotated[dict[str, list[float | None]], Field(max_length=_MAX_NAMES)] = {}
    end: str | None = None


def feedback_as_json(feedback: Feedback) -> dict[str, Any]:
    """Feedback as JSON types; infinite ranges are ``null``."""
    return _plain({"version": SCENE_VERSION, **vars(feedback)})  # type: ignore[no-any-return]


def feedback_of(data: Any) -> Feedback:
    """Feedback from JSON types: names -> three numbers each; ranges are lists, ``null`` for a beam that hit nothing.

    Raises:
        BridgeError: Keys are unknown, or values are not finite numbers (``bridge-failed``).
    """
    try:
        message = _Message.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"]) or "the message"
        keys = "poses, twists, commands, goals, starts, ranges, end"
        raise BridgeError(
            "bridge-failed", f"{where} cannot be used: {first['msg']}", f"send an object with {keys}"
        ) from None
    named = ("poses", "twists", "commands", "goals", "starts")
    triples: dict[str, Any] = {
        key: {name: tuple(values) for name, values in getattr(message, key).items()} for key in named
    }
    with np.errstate(over="ignore"):  # what is too large for its type is infinite
        ranges = {
            key: np.array([np.inf if value is None else value for value in values], dtype=np.float32)
            for key, values in message.ranges.items()
        }
    return Feedback(**triples, ranges=ranges, end=message.end)
