"""Exceptions of irsim. Every error that a user can repair derives from :class:`IrsimError` and says how."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from irsim.diagnostics.diagnostic import Diagnostic, format_path
from irsim.diagnostics.report import format_diagnostics

__all__ = [
    "ArgumentError",
    "BehaviorError",
    "BenchmarkError",
    "CodedError",
    "InputError",
    "InputTypeError",
    "IrsimError",
    "NotSimulatedError",
    "OverLimitError",
    "PickledWhole",
    "PlacementError",
    "PolicyError",
    "PolicyLostError",
    "ScenarioError",
    "ScenarioNotFoundError",
    "WorkerError",
    "said_by_core",
]


class PickledWhole:
    """An exception that pickle and other processes return as it was, whatever its constructor takes."""

    def __reduce__(self) -> Any:
        return _restore_error, (type(self), self.args, self.__dict__)  # type: ignore[attr-defined] # of BaseException


def _restore_error(kind: type[BaseException], args: tuple[Any, ...], attributes: dict[str, Any]) -> BaseException:
    error = kind.__new__(kind, *args)
    error.args = args
    error.__dict__.update(attributes)
    return error


def said_by_core(error: MemoryError) -> str:
    """The limit of the core that was exceeded, as the end of a sentence; empty for other errors of memory."""
    return str(error) if str(error).startswith("more than") else ""


class IrsimError(PickledWhole, Exception):
    """Base of all errors that irsim raises on purpose.

    ``except irsim.IrsimError as error: print(error.code)`` works for all of them.

    Attributes:
        code: Code of the closed list in :mod:`irsim.diagnostics.codes`; of several problems, the code of the first.
        message: The problem, without the code.
        fix: The remedy, or None.
        where: Argument or key that is wrong, or None.
        allowed: Accepted values, where they are a short list.
    """

    code: str = "invalid-input"
    message: str = ""
    fix: str | None = None
    where: str | None = None
    allowed: Sequence[str] = ()
    _problems: list[Diagnostic] | None = None

    def _tell(
        self, code: str, message: str, fix: str | None, where: str | None = None, allowed: Sequence[str] = ()
    ) -> None:
        """Set the attributes; a class may have its own ``where``."""
        self.code, self.message, self.fix, self.allowed = code, message, fix, tuple(allowed)
        self.where = self.where if where is None else where

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """All problems of a file as data, errors first; of any other error the one problem."""
        if self._problems:
            return self._problems
        path = (self.where,) if self.where else ()
        text, allowed, fix = self.message or str(self), self.allowed or None, self.fix or None
        return [Diagnostic(self.code, "error", path, text, allowed=allowed, fix=fix)]

    @diagnostics.setter
    def diagnostics(self, problems: Sequence[Diagnostic]) -> None:
        self._problems = list(problems)


class ScenarioError(IrsimError, ValueError):
    """A scenario that cannot be used: ``diagnostics`` has all findings, errors first, warnings included."""

    def __init__(self, diagnostics: Sequence[Diagnostic], source: str | None = None) -> None:
        self.diagnostics = list(diagnostics)
        first = diagnostics[0]
        self._tell(first.code, first.message, first.fix, format_path(first.path))
        self.source = source
        super().__init__("\n" + format_diagnostics(diagnostics, source))


class CodedError(IrsimError):
    """An error whose text has code, message and fix."""

    def __init__(
        self, code: str, message: str, fix: str | None = None, *, where: str | None = None, allowed: Sequence[str] = ()
    ) -> None:
        self._tell(code, message, fix, where, allowed)
        super().__init__(self._text())

    def _text(self) -> str:
        return (
            f"{self.code}: {_sentence(self.message)} Fix: {_sentence(self.fix)}"
            if self.fix
            else f"{self.code}: {self.message}"
        )


def _sentence(text: str) -> str:
    return text if text.endswith((".", "?", "!")) else f"{text}."


class OverLimitError(CodedError, ValueError):
    """A request asks for more work than the limits allow."""

    code = "over-limit"

    def __init__(self, message: str, fix: str) -> None:
        super().__init__(self.code, message, fix)


class InputError(CodedError, ValueError):
    """An argument of a function, a command or a tool has an invalid value."""

    code = "bad-argument"

    def __init__(
        self, message: str, fix: str | None = None, where: str | None = None, allowed: Sequence[str] = ()
    ) -> None:
        super().__init__(self.code, message, fix, where=where, allowed=allowed)


class InputTypeError(InputError, TypeError):
    """An argument of a function has a type that it cannot have."""


ArgumentError = InputError
"""Another name of :class:`InputError`."""
BenchmarkError = InputError
"""The name that ``irsim.benchmarks`` has for :class:`InputError`."""


class BehaviorError(CodedError, ValueError):
    """A behavior or a drive written in Python raised an error or returned an invalid value."""

    code = "behavior-failed"

    def __init__(self, message: str) -> None:
        super().__init__(self.code, message.removeprefix(f"{self.code}: "))


class PolicyError(CodedError, ValueError):
    """A policy failed while it decided (``policy-failed``), or cannot drive these robots (``policy-mismatch``)."""


class PolicyLostError(PolicyError):
    """A policy in another process did not answer as it should; the episode cannot go on."""

    def __init__(self, message: str, fix: str = "look at what its process prints") -> None:
        super().__init__("policy-lost", message, fix)


class WorkerError(CodedError, RuntimeError):
    """A process of irsim that does a part of the work has died."""

    def __init__(self, message: str, fix: str) -> None:
        super().__init__("worker-failed", message, fix)


class NotSimulatedError(ScenarioError):
    """The scenario is valid but uses something this version does not simulate."""


class PlacementError(ScenarioError):
    """Random placement found no free place for an object."""


class ScenarioNotFoundError(IrsimError, FileNotFoundError):
    """No scenario file has that name; the text names the places searched and near matches."""

    code = "file-not-found"

    def __init__(self, message: str, searched: Sequence[str], advice: Sequence[str], near: Sequence[str]) -> None:
        self._tell(self.code, message, " ".join(advice), allowed=near)
        super().__init__("\n".join([f"{message}. Searched:", *(f"  {place}" for place in searched), *advice]))
