"""Exceptions of irsim. Every error that a user can repair derives from :class:`IrsimError` and says how."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from irsim.diagnostics.diagnostic import Diagnostic

__all__ = [
    "ArgumentError",
    "BehaviorError",
    "BenchmarkError",
    "CodedError",
    "InputError",
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
        diagnostics: All problems of a file as data, errors first; empty where the text tells the only one.
    """

    code: str
    diagnostics: Sequence[Diagnostic] = ()


class ScenarioError(IrsimError, ValueError):
    """A scenario that cannot be used, with every problem found.

    Attributes:
        diagnostics: All findings, errors first; warnings are included.
    """

    diagnostics: list[Diagnostic]

    def __init__(self, diagnostics: Sequence[Diagnostic], source: str | None = None) -> None:
        from irsim.diagnostics.report import format_diagnostics

        self.diagnostics = list(diagnostics)
        if self.diagnostics:
            self.code = self.diagnostics[0].code
        self.source = source
        super().__init__("\n" + format_diagnostics(self.diagnostics, source))


class CodedError(IrsimError):
    """An error with a code of the closed list; its text has code, message and fix.

    Attributes:
        code: Code of the closed list in :mod:`irsim.diagnostics.codes`.
        message: The problem, without the code.
        fix: The remedy, or None.
        where: Argument that is wrong, or None.
    """

    code: str
    where: str | None = None

    def __init__(self, code: str, message: str, fix: str | None = None, *, where: str | None = None) -> None:
        self.code, self.message, self.fix = code, message, fix
        if where is not None:
            self.where = where
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

    def __init__(self, message: str, fix: str, where: str | None = None) -> None:
        super().__init__(self.code, message, fix, where=where)


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
    """No scenario file has that name; the message names the places searched and near matches."""

    code = "file-not-found"
