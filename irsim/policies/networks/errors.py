"""How large files of policies may be, and the errors about such files and about what their policies observe."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from irsim.common.records import ContentError
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic, Path, format_path
from irsim.diagnostics.errors import CodedError

__all__ = ["LIMITS", "Limits", "PolicyFileError", "PolicyInputError", "content_flaw", "flaw"]

_SHOWN = 8
"""Largest number of problems in a message."""


@dataclass(frozen=True)
class Limits:
    """Bounds for files of policies, checked before anything is unpacked or computed.

    Attributes:
        file_bytes: Size of the file.
        unpacked_bytes: Size of all arrays together.
        document_bytes: Size of the JSON document.
        arrays: Number of arrays.
        layers: Number of layers.
        parameters: Number of numbers in all arrays.
        numbers: Numbers that all layers together return for one robot.
        work: Multiplications of one decision of one robot, roughly.
    """

    file_bytes: int = 64_000_000
    unpacked_bytes: int = 128_000_000
    document_bytes: int = 1_000_000
    arrays: int = 2_000
    layers: int = 500
    parameters: int = 16_000_000
    numbers: int = 1_000_000
    work: int = 100_000_000


LIMITS = Limits()
"""The usual limits."""


def flaw(where: str | Path, message: str, given: str = "", allowed: str = "") -> Diagnostic:
    """The problem at one place of a file of a policy.

    Args:
        where: Place in the document, such as ``("network", 2, "units")``, or name of an array; empty for the file.
        message: The problem in words.
        given: The value that is wrong, as text; may be empty.
        allowed: The accepted values, as text; empty if the message says so.
    """
    path = ((where,) if where else ()) if isinstance(where, str) else where
    text = message + (f", given: {given}" if given else "") + (f", allowed: {allowed}" if allowed else "")
    return Diagnostic("invalid-value", "error", path, text, given=given or None, allowed=allowed or None)


def content_flaw(error: ContentError) -> Diagnostic:
    """The problem that a reader of archives reports."""
    return flaw(error.place, error.message, error.given, error.allowed)


class PolicyFileError(CodedError, ValueError):
    """A policy file cannot be read or written.

    Attributes:
        problems: Everything that was found to be wrong.
    """

    def __init__(self, source: str, problems: Sequence[Diagnostic], fix: str) -> None:
        self.problems = tuple(problems)
        more = len(self.problems) - _SHOWN
        shown = "; ".join(map(_text, self.problems[:_SHOWN])) + (f"; and {more} more" if more > 0 else "")
        path = self.problems[0].path
        self.diagnostics = [replace(problem, file=source) for problem in self.problems]
        super().__init__("policy-file", f"{source}: {shown}", fix, where=format_path(path) if path else None)


def _text(problem: Diagnostic) -> str:
    message = clean(problem.message, 300)
    text = f"{format_path(problem.path)}: {message}" if problem.path else message
    choices = () if isinstance(problem.allowed, str) else problem.allowed or ()
    more = problem.fix or (f"allowed: {', '.join(map(str, choices))}" if choices else "")
    return text + (f" ({more})" if more else "")


class PolicyInputError(CodedError, ValueError):
    """The robots do not observe what a policy needs."""

    def __init__(self, message: str, fix: str) -> None:
        super().__init__("policy-input", message, fix)
