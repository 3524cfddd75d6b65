"""``process``: a policy in another process."""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from typing import Any

import numpy as np

from irsim.common.arguments import as_given, is_number
from irsim.common.arrays import Floats
from irsim.common.text import plural
from irsim.diagnostics.errors import ArgumentError, PolicyLostError
from irsim.policies.observations import Observations
from irsim.policies.policy import Episode, Policy
from irsim.policies.process import messages
from irsim.policies.process.channel import Channel, PeerError, connect, start

__all__ = ["ProcessPolicy"]

_ANSWERS = messages.FIX


class ProcessPolicy(Policy):
    """A policy in another process, which answers lines of JSON: its program is started, or listens on a local socket.

    The lines are described in :mod:`irsim.policies.process.messages` and in ``irsim describe process``. If the process
    does not answer in time, ends, or answers nonsense, the episode ends with that reason; the next episode starts or
    connects again. It ends with the policy object.

    Args:
        command: Program and arguments, such as ``[python, mine.py]``; it is started in the current folder.
        address: Instead of a command, where the process listens: ``127.0.0.1:9000``, or the path of a socket.
        timeout: Longest time of a decision [s].
        start_timeout: Longest time until it is ready [s].

    Raises:
        ArgumentError: An option is not of its kind.
        PolicyLostError: The process cannot be started or reached, or does not say what it is.
    """

    may_be_lost = True

    def __init__(
        self,
        command: Sequence[str] | None = None,
        address: str | None = None,
        timeout: float = 5.0,
        start_timeout: float = 30.0,
    ) -> None:
        if (command is None) == (address is None):
            what = "a policy in another process is started by its command, or listens at its address"
            raise ArgumentError(what, "write {name: process, command: [python, mine.py]}, or address: 127.0.0.1:9000")
        if command is not None and not _is_command(command):
            raise ArgumentError(f"command must be a list of texts, got {as_given(command)}", "write [python, mine.py]")
        if address is not None and not _is_text(address):
            raise ArgumentError(f"address must be a text, got {as_given(address)}", "write 127.0.0.1:9000")
        for key, value in (("timeout", timeout), ("start_timeout", start_timeout)):
            if not (is_number(value) and 0 < value <= 3600):
                raise ArgumentError(f"{key} must be a time from 0 to 3600 s, got {as_given(value)}", "write 5")
        self.name = "process"
        self._command, self._address = command, address
        self._timeout, self._start_timeout = float(timeout), float(start_timeout)
        self._channel: Channel | None = None
        self._said: dict[str, Any] | None = None
        self._open()

    def reset(self, episode: Episode, rng: np.random.Generator) -> None:
        """Begin an episode, with a new process if the last one was lost."""
        if self._channel is None:
            self._open()
        self._ask(messages.reset(episode, int(rng.integers(2**53))), "ready", "start_timeout")

    def act(self, observations: Observations) -> Floats:
        """The decisions of the other process.

        Raises:
            PolicyLostError: It does not answer in time, has ended, or answers nonsense.
        """
        data = self._ask(messages.act(observations), "decision", "timeout")
        try:
            result: Floats = np.asarray(data.get("decision"), dtype=np.float64)
        except (TypeError, ValueError):
            raise self._lost("decided something that is not a table of numbers", _ANSWERS) from None
        if result.ndim != 2 or len(result) != len(observations):
            rows = plural(len(observations), "row")
            raise self._lost(f"decided an array of shape {result.shape} where {rows} of numbers are expected", _ANSWERS)
        if not np.isfinite(result).all():
            raise self._lost("decided numbers that are not finite, or null", _ANSWERS)
        return result

    def close(self) -> None:
        """End the process, or the connection to it."""
        if self._channel is not None:
            self._channel.close()
            self._channel = None

    def _open(self) -> None:
        try:
            if self._command is not None:
                self._channel = start(self._command)
            else:
                self._channel = connect(str(self._address), self._start_timeout)
        except PeerError as error:
            raise self._lost(str(error), error.fix) from error
        weakref.finalize(self, self._channel.close)
        data = self._ask(messages.hello(), "policy", "start_timeout")
        try:
            said = messages.declaration(data)
        except PeerError as error:
            raise self._lost(str(error), error.fix) from error
        if self._said is not None and said != self._said:
            raise self._lost("declares something else than before", _ANSWERS)
        self._said = said
        for key, value in said.items():
            setattr(self, key, value)

    def _ask(self, line: bytes, kind: str, limit: str) -> dict[str, Any]:
        """The answer to a line, within the time of the option ``limit``."""
        if self._channel is None:
            raise self._lost("was lost before", "begin a new episode")
        seconds = self._timeout if limit == "timeout" else self._start_timeout
        try:
            answer = self._channel.ask(line, seconds)
        except TimeoutError:
            fix = f"look at what its process does; a slow one needs a longer {limit}"
            raise self._lost(f"gave no answer within {seconds:g} s", fix) from None
        except PeerError as error:
            raise self._lost(str(error), error.fix) from error
        try:
            return messages.answer(answer, kind)
        except PeerError as error:
            raise self._lost(str(error), error.fix) from error

    def _lost(self, why: str, fix: str) -> PolicyLostError:
        self.close()
        where = f"of the program {self._command[0]!r}" if self._command is not None else f"at {self._address!r}"
        return PolicyLostError(f"the policy {where} {why}", fix)


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and bool(value)


def _is_command(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and bool(value) and all(map(_is_text, value))
