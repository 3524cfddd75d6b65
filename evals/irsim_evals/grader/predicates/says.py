"""``says``: what the reply must, or must not, tell the user."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from pydantic import field_validator

from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material

_MAX_QUOTED = 120
"""Number of characters of a reply that an observation quotes."""


@register("says")
class Says(AnswerPredicate):
    """Words in the reply, as regular expressions that ignore case and line breaks."""

    all_of: list[str] = []
    """Each of these occurs."""
    any_of: list[str] = []
    """At least one of these occurs."""
    none_of: list[str] = []
    """None of these occurs."""
    about: str = ""
    """What it says, in words, for the evidence."""
    turn: int | None = None
    """Number of the turn whose reply is meant, from 1 on; default: the last one."""

    @field_validator("all_of", "any_of", "none_of")
    @classmethod
    def _compiles(cls, patterns: list[str]) -> list[str]:
        for pattern in patterns:
            re.compile(pattern)
        return patterns

    def observe(self, material: Material) -> Observation:
        """Search the reply."""
        reply = material.reply
        if self.turn is not None:
            reply = material.replies[self.turn - 1] if self.turn <= len(material.replies) else ""
        text = re.sub(r"\s+", " ", reply)

        def occurs(pattern: str) -> bool:
            return re.search(pattern, text, re.IGNORECASE) is not None

        missing = [pattern for pattern in self.all_of if not occurs(pattern)]
        unwanted = [pattern for pattern in self.none_of if occurs(pattern)]
        lacking = bool(self.any_of) and not any(map(occurs, self.any_of))
        expected = (
            f"says {self.about or 'so'}, in words that the case knows ({len(self.any_of) + len(self.all_of)} ways)"
        )
        if unwanted:
            found = re.search(unwanted[0], text, re.IGNORECASE)
            expected += f"; it must not say {found[0]!r}" if found else ""
        quoted = text if len(text) <= _MAX_QUOTED else text[:_MAX_QUOTED] + " …"
        return Observation(
            bool(text) and not (missing or unwanted or lacking), f"the reply {expected}", quoted or "no reply"
        )
