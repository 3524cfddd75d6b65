"""Connecting to a server of CARLA, what its errors mean, and its town while a scenario is in it."""

from __future__ import annotations

import math
import socket
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from irsim.bridges.base import BridgeError, BridgeLostError
from irsim.bridges.carla.actors import Ground, Spawner
from irsim.common.extras import ExtraError, require
from irsim.common.text import clean
from irsim.components.bridges.carla import Carla

__all__ = ["NEWEST_PYTHON", "Town", "connect", "import_client", "server_errors", "server_version"]

_CALL = b"\x94\x00\x01\xa7version\x91\x91\xc2"
_ANSWER = b"\x94\x01\x01"
"""How the answer begins."""
_VALUE = b"\xc0\x91\x92\x01"
"""The bytes that follow if there was no error; the text comes next."""
_LONGEST = 300
"""Most bytes of an answer, and most characters of an error."""
_AGAIN = 0.2
"""Time between two attempts to connect [s]: a server may be about to start."""
_START = "start a server first, such as ./CarlaUE4.sh -RenderOffScreen, and check host, port and timeout"


def server_version(host: str, port: int, timeout: float) -> str:
    """The version of the server at an address.

    Args:
        host: Computer.
        port: Port of calls.
        timeout: Time for a connection and an answer together [s].

    Raises:
        BridgeLostError: Nothing listens or answers in time.
        BridgeError: The server that answers is not CARLA.
    """
    deadline = time.monotonic() + timeout
    try:
        with _connected(host, port, deadline) as connection:
            connection.sendall(_CALL)
            answer = _received(connection, deadline)
    except OSError as error:
        why = error.strerror or str(error) or "no answer"
        what = f"no CARLA server answers at {host}:{port} within {timeout:g} s: {why}"
        raise BridgeLostError(what, _START) from None
    version = _text(answer[len(_ANSWER) + len(_VALUE) :])
    if not answer.startswith(_ANSWER + _VALUE) or version is None:
        what = f"what listens at {host}:{port} is not a CARLA server: it answered {answer[:20]!r}"
        if answer.startswith(_ANSWER):
            what = f"the server at {host}:{port} does not say its version, as CARLA much before 0.9.16: {answer[:20]!r}"
        raise BridgeError("bridge-mismatch", what, "check host, port and version; CARLA's usual port is 2000")
    return version


def _connected(host: str, port: int, deadline: float) -> socket.socket:
    while True:
        left = deadline - time.monotonic()
        try:
            return socket.create_connection((host, port), timeout=max(0.01, left))
        except ConnectionRefusedError:
            if left < _AGAIN:
                raise
            time.sleep(_AGAIN)


def _received(connection: socket.socket, deadline: float) -> bytes:
    """The beginning of an answer, until it cannot be a version, or is complete."""
    answer = b""
    while len(answer) < _LONGEST:
        left = deadline - time.monotonic()
        if left <= 0:
            raise TimeoutError
        connection.settimeout(left)
        received = connection.recv(_LONGEST)
        answer += received
        head = _ANSWER + _VALUE
        if not received or answer[: len(head)] != head[: len(answer)] or _text(answer[len(head) :]) is not None:
            break
    if not answer:
        raise ConnectionResetError(0, "the connection was closed")
    return answer


def _text(data: bytes) -> str | None:
    """A short string of msgpack; None if it is something else or incomplete."""
    if data and 0xA0 <= data[0] <= 0xBF:
        start, length = 1, data[0] & 0x1F
    elif len(data) > 1 and data[0] == 0xD9:
        start, length = 2, data[1]
    else:
        return None
    result = data[start : start + length]
    return result.decode("utf-8", "replace") if len(result) == length else None


NEWEST_PYTHON = (3, 12)
"""The newest Python that the client is made for."""
_LOST = ("time-out", "timeout", "rpc::", "connection", "broken pipe")
"""Words of errors of a server that is gone."""


def import_client() -> Any:
    """The module ``carla``.

    Raises:
        ExtraError: It is not installed, or does not exist for this Python.
    """
    try:
        require("carla", "carla")
    except ExtraError:
        if sys.version_info[:2] <= NEWEST_PYTHON:
            raise
        what = f"the client of CARLA is made for Python up to {NEWEST_PYTHON[0]}.{NEWEST_PYTHON[1]}"
        fix = "use another Python: uv venv --python 3.12, then pip install 'irsim-mcp[carla]'"
        raise ExtraError(
            "missing-extra", f"{what}, and this is {sys.version_info[0]}.{sys.version_info[1]}", fix
        ) from None
    import carla

    return carla


@contextmanager
def server_errors(what: str, address: str, lose: Callable[[], None] | None = None) -> Iterator[None]:
    """Turn errors of the client, which all are a ``RuntimeError``, into one that says what failed.

    Args:
        what: The action that is guarded, for messages.
        address: Where the server is.
        lose: Called if the server does not answer.
    """
    try:
        yield
    except BridgeLostError:
        if lose is not None:
            lose()
        raise
    except RuntimeError as error:
        text = clean(str(error), _LONGEST)
        if any(word in text.lower() for word in _LOST):
            if lose is not None:
                lose()
            raise BridgeLostError(f"the CARLA server at {address} did not answer ({what}): {text}") from None
        raise BridgeError("bridge-failed", f"CARLA refused {what}: {text}", "look at the log of the server") from None


def connect(options: Carla) -> tuple[Any, Any, Any]:
    """The module ``carla``, a client of the server, and its world.

    Raises:
        ExtraError: The client library is missing.
        BridgeLostError: No server answers within the timeout.
        BridgeError: The server that answers is not CARLA, or has another version or another town.
    """
    carla = import_client()
    address = f"{options.host}:{options.port}"
    theirs = server_version(options.host, options.port, options.timeout)
    with server_errors("connecting", address):
        client = carla.Client(options.host, options.port)
        client.set_timeout(options.timeout)
        ours = client.get_client_version()
    if theirs != ours and not options.any_version:
        what = f"the CARLA server at {address} has version {clean(theirs, 40)}, and the client of this Python {ours}"
        fix = f"install the client of the server: pip install carla=={clean(theirs, 40)}; or try any_version: true"
        raise BridgeError("bridge-mismatch", what, fix)
    with server_errors("getting the world", address):
        world = client.get_world()
    if options.town is not None:
        with server_errors("getting the map", address):
            name = str(world.get_map().name)
        if name.rsplit("/", 1)[-1] != options.town.rsplit("/", 1)[-1]:
            what = f"the CARLA server at {address} has loaded {clean(name)}, not {clean(options.town)}"
            fix = f"load it: python PythonAPI/util/config.py --map {clean(options.town)}; or write town: {clean(name)}"
            raise BridgeError("bridge-mismatch", what, fix)
    return carla, client, world


_LONGEST_TICK = 0.1
"""Longest tick [s] that the physics of CARLA takes with its own settings."""
_SETTLING = 0.5
"""Time for which actors fall to the ground and stand, before the scenario starts [s]."""
_LAST_TRY = 2.0
"""Time for which a server that is lost is asked to destroy the actors [s]."""


class Town:
    """A town that was connected to.

    Args:
        options: The options.
        period: Duration of a step of the scenario [s].

    Attributes:
        carla: The module.
        world: The world of the client.
        spawner: Spawns actors, and knows all that it has spawned.
        ground: Heights of the ground.
        tick: Period of CARLA [s].
        ticks: Number of ticks so far.

    Raises:
        BridgeError: No server answers, or it does not fit.
    """

    def __init__(self, options: Carla, period: float) -> None:
        self.options, self.period, self.ticks = options, period, 0
        self.carla, self._client, self.world = connect(options)
        self._settings: Any = None
        self._time: float | None = None
        self.tick = period
        self.spawner = Spawner(self.carla, self.world)
        self.ground = Ground(self.carla, self.world, options.ground)

    def take_over(self) -> None:
        """Make the server synchronous, or check that another client ticks it in a way that fits.

        Raises:
            BridgeError: Steps are not a whole number of ticks.
        """
        settings = self.world.get_settings()
        if self.options.clock == "external":
            result = settings.fixed_delta_seconds
            if not result or not _is_whole(self.period / result):
                what = f"CARLA has ticks of {result} s, and steps of {self.period:g} s are not a whole number of them"
                fix = (
                    f"let the program that ticks CARLA set fixed_delta_seconds to {self.period:g}, or change step_time"
                )
                raise BridgeError("bridge-mismatch", what, fix)
            self.tick = float(result)
            return
        usual = self.period / math.ceil(self.period / _LONGEST_TICK - 1e-9)
        self.tick = self.options.tick or usual
        if not _is_whole(self.period / self.tick):
            what = f"steps of {self.period:g} s are not a whole number of ticks of {self.tick:g} s"
            raise BridgeError("bridge-mismatch", what, f"tick: {usual:g}")
        self._settings = self.world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, self.tick
        settings.no_rendering_mode = not self.options.rendering
        self.world.apply_settings(settings)

    def settle(self) -> None:
        """Let actors fall to the ground."""
        if self.options.clock == "external":
            self._time = float(self.world.wait_for_tick(self.options.timeout).timestamp.elapsed_seconds)
            return
        for _ in range(math.ceil(_SETTLING / self.tick)):
            self._tick_once()

    def pass_time(self) -> int:
        """Let one step pass; the last frame of it."""
        if self.options.clock == "irsim":
            return max(self._tick_once() for _ in range(round(self.period / self.tick)))
        assert self._time is not None
        self._time += self.period
        snapshot = self.world.get_snapshot()
        while float(snapshot.timestamp.elapsed_seconds) < self._time - self.tick / 2:
            snapshot = self.world.wait_for_tick(self.options.timeout)
            self.ticks += 1
        return int(snapshot.frame)

    def _tick_once(self) -> int:
        self.ticks += 1
        return int(self.world.tick(self.options.timeout))

    def apply(self, commands: list[Any]) -> None:
        """Give all commands of a step in one message.

        Raises:
            BridgeError: The server refuses one.
        """
        if not commands:
            return
        for answer in self._client.apply_batch_sync(commands, False):
            if answer.error:
                raise BridgeError("bridge-failed", f"CARLA refused a command: {answer.error}", "look at its log")

    def leave(self, *, lost: bool) -> None:
        """Destroy all actors and restore the settings.

        Args:
            lost: Whether the server is lost: it is then asked once, for a short time.

        Raises:
            BridgeError: The server that is not lost does not do it.
        """
        if lost:
            self._client.set_timeout(min(_LAST_TRY, self.options.timeout))
        errors = []
        for undo in (self._destroy_all, self._restore):
            try:
                undo()
            except RuntimeError as error:
                errors.append(error)
                if lost:
                    return
        if errors:
            what = f"the CARLA server at {self.options.host}:{self.options.port} did not clean up: {errors[0]}"
            raise BridgeError("bridge-failed", what, "restart the server, or reload its town")

    def _destroy_all(self) -> None:
        doomed, self.spawner.spawned = list(reversed(self.spawner.spawned)), []
        if doomed:
            self._client.apply_batch_sync([self.carla.command.DestroyActor(number) for number in doomed], False)

    def _restore(self) -> None:
        settings, self._settings = self._settings, None
        if settings is not None:
            self.world.apply_settings(settings)


def _is_whole(number: float) -> bool:
    return round(number) >= 1 and abs(number - round(number)) < 1e-4
