"""The messages of ``json_lines``: scenes, states and motions as JSON, and feedback from JSON."""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from irsim.bridges.base import BridgeError
from irsim.bridges.state import Feedback, Motion, WorldState
from irsim.common.outline import BodyPart, Circle, Polygon
from irsim.diagnostics.diagnostic import format_path
from irsim.scenario.file_kind import explained
from irsim.scenario.yaml.document import Document
from irsim.simulation.scene import SCENE_VERSION, SceneDescription

__all__ = ["feedback_of", "motion_as_json", "scene_as_json", "state_as_json"]

_MAX_NAMES = 100_000
"""Number of objects that one message may name."""
_NOT_WRITTEN = ("row", "static", "threshold", "look")
"""Fields of objects that files of version 1 do not have."""
_BY_ROW = ("pose", "twist", "control", "goal", "arrived", "collided", "stopped")


def scene_as_json(scene: SceneDescription) -> dict[str, Any]:
    """A scene as JSON types; infinite numbers are ``null``, and cells of a map are runs of free and solid ones."""
    grid = scene.grid
    data = asdict(replace(scene, grid=None, maps=()))
    del data["maps"]
    for agent, original in zip(data["agents"], scene.agents, strict=True):
        agent["parts"] = [_part_as_json(part) for part in original.parts]
        for key in _NOT_WRITTEN:
            del agent[key]
        for lidar in agent["lidars"]:
            del lidar["between"]
    if grid is not None:
        data["grid"] = {"size": list(grid.occupied.shape), "cell": grid.cell, "origin": grid.origin,
                         "runs": _runs(grid.occupied)}  # fmt: skip
    data["about"] = dict(scene.about)
    return _plain(data)  # type: ignore[no-any-return]


def _part_as_json(part: BodyPart) -> dict[str, Any]:
    if isinstance(part, Circle):
        return {"circle": [*part.center, part.radius]}
    if isinstance(part, Polygon):
        return {"polygon": part.corners.tolist()}
    return {"line": part.points.tolist(), "closed": part.closed}


def _runs(occupied: Any) -> list[int]:
    """Lengths of the runs of free and solid cells in turns, beginning with free ones."""
    flat = np.concatenate([[False], np.asarray(occupied, dtype=bool).reshape(-1)])
    changes = np.flatnonzero(flat[1:] != flat[:-1])
    edges = np.concatenate([[0], changes, [len(flat) - 1]])
    result: list[int] = np.diff(edges).tolist()
    return result


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


def state_as_json(state: WorldState) -> dict[str, Any]:
    """A state as JSON types; NaN and infinities are ``null``."""
    result: dict[str, Any] = {"version": SCENE_VERSION, "step": state.step, "time": state.time}
    result |= {key: getattr(state, key) for key in _BY_ROW}
    result |= {"ranges": dict(state.ranges), "paths": dict(state.paths)}
    return _plain(result)  # type: ignore[no-any-return]


def motion_as_json(motion: Motion) -> dict[str, Any]:
    """The middle of a step as JSON types."""
    return _plain({"version": SCENE_VERSION, **asdict(motion)})  # type: ignore[no-any-return]


def _is_finite(values: list[float]) -> list[float]:
    if not all(math.isfinite(value) for value in values):
        raise ValueError("numbers must be finite")
    return values


_Three = Annotated[list[float], Field(min_length=3, max_length=3), AfterValidator(_is_finite)]
_Named = Annotated[dict[str, _Three], Field(max_length=_MAX_NAMES)]


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", title="Message")

    version: Literal[1] = 1
    poses: _Named = {}
    twists: _Named = {}
    commands: _Named = {}
    goals: _Named = {}
    starts: _Named = {}
    ranges: Annotated[dict[str, list[float | None]], Field(max_length=_MAX_NAMES)] = {}
    end: str | None = None


def feedback_of(data: Any) -> Feedback:
    """Feedback from JSON types: names -> three numbers each; ranges are lists, ``null`` for a beam that hit nothing.

    Raises:
        BridgeError: Keys are unknown, or values are not finite numbers (``bridge-failed``).
    """
    try:
        message = _Message.model_validate(data)
    except ValidationError as error:
        first = explained(error, Document(data), _Message)[0]
        keys = "poses, twists, commands, goals, starts, ranges, end"
        what = f"{format_path(first.path)} cannot be used: {first.message}"
        raise BridgeError("bridge-failed", what, f"send an object with {keys}") from None
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
