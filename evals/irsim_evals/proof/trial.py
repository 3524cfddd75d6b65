"""One answer of which it is known whether it is right, or of which the two worlds say it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from irsim_evals.cases.instance import Instance
from irsim_evals.cases.store import Answer

__all__ = ["Kind", "Trial"]

Kind = Literal["gold", "rewrite", "mutant", "pinned mutant", "broken mutant", "free mutant", "null"]
"""What a trial is. A ``mutant`` is a changed scenario whose world has not been compared with the original one yet."""


@dataclass(frozen=True)
class Trial:
    """One answer, and what it was made from.

    Attributes:
        case, gold: Case and gold that it was made from.
        kind: What it is.
        operator: What made it.
        what: What was changed.
        instance, answer: What is graded.
        file: Name of the scenario in the answer that was changed; empty if another part was.
        original: Text of that scenario before.
    """

    case: str
    gold: str
    kind: Kind
    operator: str
    what: str
    instance: Instance = field(repr=False)
    answer: Answer = field(repr=False)
    file: str = ""
    original: str = field(default="", repr=False)

    @property
    def right(self) -> bool:
        """Whether the grader must accept it."""
        return self.kind in ("gold", "rewrite", "free mutant")
