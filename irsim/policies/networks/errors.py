"""Errors about files of policies and about what such policies observe."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from irsim.diagnostics.errors import CodedError

__all__ = ["PolicyFileError", "PolicyInputError", "Problem"]

_SHOWN = 8
"""Largest number of problems in a message."""


@dataclass(frozen=True)
class Problem:
    """What is wrong at one place of a file.

    Attributes:
        where: Place in the document, such as ``network[2].units``, or name of an array; empty for the file.
        message: What is wrong.
        given: The value that is wrong, as text; empty if there is none.
        allowed: What is accepted, as text; empty if the message says so.
    """

    where: str
    message: str
    given: str = ""
    allowed: str = ""

    def __str__(self) -> str:
        text = f"{self.where}: {self.message}" if self.where else self.message
        text += f", given: {self.given}" if self.given else ""
        return text + (f", allowed: {self.allowed}" if self.allowed else "")


class PolicyFileError(CodedError, ValueError):
    """A file of a policy cannot be used, or none can be made.

    Attributes:
        problems: Everything that was found to be wrong.
    """

    def __init__(self, source: str, problems: Sequence[Problem], fix: str) -> None:
        self.problems = tuple(problems)
        more = len(self.problems) - _SHOWN
        shown = "; ".join(map(str, self.problems[:_SHOWN])) + (f"; and {more} more" if more > 0 else "")
        super().__init__("policy-file", f"{source}: {shown}", fix, where=self.problems[0].where or None)


class PolicyInputError(CodedError, ValueError):
    """The robots do not observe what a policy needs."""

    def __init__(self, message: str, fix: str) -> None:
        super().__init__("policy-input", message, fix)
