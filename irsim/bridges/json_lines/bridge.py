"""``json_lines``: a bridge to any program that reads and writes lines of JSON over a TCP socket.

irsim connects to the program and sends one object per line, with the key ``kind``:

- ``scene``: the scene, and the state at the start; once more when a reset has drawn another scene
- ``pull``: with ``clock: external`` only, before each step: irsim waits for the answer
- ``motion``: only if the program moves objects: what the objects want in this step, and where irsim would have them
- ``state``: all objects after a step
- ``end``: the connection is about to be closed

A line of the program is an object with any of the keys of :class:`irsim.bridges.state.Feedback`; ``{}`` says nothing.
"""

from __future__ import annotations

import json
import math
import selectors
import socket
import time
from dataclasses import asdict, replace
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from irsim.bridges.base import Bridge, BridgeError, BridgeLostError
from irsim.bridges.state import Feedback, Motion, WorldState
from irsim.common.outline import BodyPart, Circle, Polygon
from irsim.common.records import ContentError, read_json
from irsim.components.bridges.json_lines import JsonLines
from irsim.diagnostics.diagnostic import format_path
from irsim.scenario.file_kind import explained
from irsim.scenario.yaml.document import Document
from irsim.simulation.scene import SCENE_VERSION, SceneDescription

__all__ = ["JsonLinesBridge", "feedback_of", "make", "motion_as_json", "scene_as_json", "state_as_json"]

_MAX_NAMES = 100_000
"""Number of objects that one message may name."""
_NOT_WRITTEN = ("row", "static", "threshold", "look")
"""Fields of objects that files of version 1 do not have."""
_SAME_TIME_S = 1e-9
_BY_ROW = ("pose", "twist", "control", "goal", "arrived", "collided", "stopped")


def scene_as_json(scene: SceneDescription) -> dict[str, Any]:
    """A scene as JSON types; infinite numbers are ``null``, cells of a map are runs of free and solid ones."""
    grid = scene.grid
    data = asdict(replace(scene, grid=None, maps=()))
    del data["maps"]
    for agent, original in zip(data["agents"], scene.agents, strict=True):
        agent["parts"] = [_part_as_json(part) for part in original.parts]
        for key in _NOT_WRITTEN:
            del agent[key]
        for lidar in agent["lidars"]:
            del lidar["between"], lidar["beam_time"]
        if not agent["gauges"]:
            del agent["gauges"]
    if grid is not None:
        data["grid"] = {"size": list(grid.occupied.shape), "cell": grid.cell, "origin": grid.origin,
                         "runs": _runs(grid.occupied)}  # fmt: skip
        if grid.unknown.any():
            data["grid"]["unknown"] = _runs(grid.unknown)
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
    if state.readings:
        result["readings"] = {key: _reading_as_json(reading) for key, reading in state.readings.items()}
    old = {key: time for key, time in state.stamps.items() if not abs(time - state.time) < _SAME_TIME_S}
    if old:
        result["stamps"] = old
    return _plain(result)  # type: ignore[no-any-return]


def _reading_as_json(reading: Any) -> Any:
    """Numbers by name; of a sensor that reports rows of them, a list of the rows that have any."""
    names = reading.dtype.names
    if not reading.shape:
        return dict(zip(names, reading.tolist(), strict=True))
    rows = reading[np.isfinite(reading[names[0]])].tolist()
    return [dict(zip(names, row, strict=True)) for row in rows]


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


_MAX_LINE = 4 * 1024 * 1024
"""Longest line of the program [bytes]."""
_MAX_LINES = 1000
"""Number of lines that may wait before a step; the last of each kind counts."""


def make(options: JsonLines) -> JsonLinesBridge:
    """The bridge of some options."""
    return JsonLinesBridge(options)


class JsonLinesBridge(Bridge):
    """Sends scene and states as lines, and reads lines of feedback."""

    def __init__(self, options: JsonLines) -> None:
        self.name = f"json_lines {options.address}"
        self.options = options
        self.agents = frozenset(options.agents)
        self._socket: socket.socket | None = None
        self._text = b""
        self._last: Feedback | None = None

    @property
    def peer(self) -> str:
        """The program."""
        return f"the program at {self.options.address}"

    def open(self, scene: SceneDescription, start: WorldState) -> None:
        """Connect to the program and send the scene."""
        host, _, port = self.options.address.rpartition(":")
        try:
            self._socket = socket.create_connection((host.strip("[]"), int(port)), self.options.timeout)
        except OSError as error:
            what = f"no program listens at {self.options.address}: {error.strerror or error}"
            raise BridgeLostError(what, "start the program first, or change the address") from None
        self._send("scene", {"scene": scene_as_json(scene), "state": state_as_json(start)})
        if self.options.answers:
            self._answer()

    def renew(self, scene: SceneDescription, start: WorldState) -> None:
        """Send the new scene; its state follows."""
        self._send("scene", {"scene": scene_as_json(scene), "state": state_as_json(start)})
        if self.options.answers:
            self._answer()

    def pull(self) -> Feedback | None:
        """The messages of the program since the last step."""
        if self.options.clock == "external":
            self._send("pull", {})
            return self._answer()
        if self.options.answers:
            result, self._last = self._last, None
            return result
        return self._waiting()

    def exchange(self, motion: Motion) -> Feedback | None:
        """Where the program has its objects."""
        if not self.agents:
            return None
        self._send("motion", motion_as_json(motion))
        feedback = self._answer()
        if missing := self.agents - feedback.poses.keys():
            what = f"{self.name} did not say where '{min(missing)}' is"
            raise BridgeError("bridge-failed", what, "answer each motion with the poses of all agents")
        return feedback

    def push(self, state: WorldState) -> None:
        """Send the state."""
        self._send("state", state_as_json(state))
        if self.options.answers:
            self._last = self._answer()

    def close(self) -> None:
        """Say that this is the end, and disconnect."""
        if self._socket is None:
            return
        try:
            self._send("end", {})
            self._socket.shutdown(socket.SHUT_WR)
            self._drain()
        except (BridgeLostError, OSError):
            pass  # the program has left already
        finally:
            if self._socket is not None:
                self._socket.close()
            self._socket = None

    def _drain(self) -> None:
        """Wait until the program has read everything and left: what stays unread would break its connection."""
        deadline = time.monotonic() + min(1.0, self.options.timeout)
        while (left := deadline - time.monotonic()) > 0 and self._receive(left):
            self._text = b""

    def _send(self, kind: str, content: dict[str, Any]) -> None:
        assert self._socket is not None
        self._socket.settimeout(self.options.timeout)
        try:
            self._socket.sendall(json.dumps({"kind": kind, **content}, allow_nan=False).encode() + b"\n")
        except OSError as error:
            self._lose(f"{self.name} takes nothing more: {error.strerror or error}")

    def _answer(self) -> Feedback:
        """Wait for one line."""
        deadline = time.monotonic() + self.options.timeout
        while b"\n" not in self._text:
            left = deadline - time.monotonic()
            if left <= 0 or not self._receive(left):
                self._lose(f"{self.name} did not answer within {self.options.timeout:g} s")
        line, _, self._text = self._text.partition(b"\n")
        return self._read(line)

    def _waiting(self) -> Feedback | None:
        """All lines that wait, as one feedback: of each object the last counts."""
        while len(self._text) < _MAX_LINE and self._receive(0.0):
            pass
        *lines, self._text = self._text.split(b"\n")
        if len(self._text) >= _MAX_LINE:
            self._lose(f"{self.name} sent a line of more than {_MAX_LINE // 2**20} MB")
        if not lines:
            return None
        result: dict[str, Any] = {}
        for line in lines[-_MAX_LINES:]:
            for key, value in vars(self._read(line)).items():
                result[key] = {**result.get(key, {}), **value} if isinstance(value, dict) else value or result.get(key)
        return Feedback(**result)

    def _receive(self, wait: float) -> bool:
        """Receive what has come within a time [s]; False if nothing has."""
        assert self._socket is not None
        with selectors.DefaultSelector() as selector:
            selector.register(self._socket, selectors.EVENT_READ)
            if not selector.select(wait):
                return False
        try:
            received = self._socket.recv(1 << 16)
        except OSError as error:
            self._lose(f"{self.name} is gone: {error.strerror or error}")
        if not received:
            self._lose(f"{self.name} has closed the connection")
        self._text += received
        if len(self._text) > _MAX_LINE + (1 << 16) and b"\n" not in self._text:
            self._lose(f"{self.name} sent a line of more than {_MAX_LINE // 2**20} MB")
        return True

    def _read(self, line: bytes) -> Feedback:
        try:
            data = read_json(line)
        except ContentError:
            what = f"{self.name} sent a line that is not JSON: {line[:60]!r}"
            raise BridgeError("bridge-failed", what, "send one JSON object per line") from None
        return feedback_of(data)

    def _lose(self, message: str) -> Any:
        if self._socket is not None:
            self._socket.close()
        self._socket = None
        raise BridgeLostError(message)
