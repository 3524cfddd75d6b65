"""``mentions_limit``: the reply says what cannot be done, in one of the ways that the case lists."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register
from irsim_evals.grader.predicates.says import Says

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material


@register("mentions_limit")
class MentionsLimit(AnswerPredicate):
    """The reply names limits, each in one of several ways."""

    limits: dict[str, list[str]]
    """Name of a limit → regular expressions, one of which occurs."""
    at_least: int | None = None
    """How many of them must be named; default: all."""

    def observe(self, material: Material) -> Observation:
        """Search for each of them."""
        named = [name for name, ways in self.limits.items() if Says(any_of=ways).observe(material).passed]
        need = len(self.limits) if self.at_least is None else self.at_least
        expected = f"{need} of: {', '.join(self.limits)}"
        return Observation(len(named) >= need, f"the reply names {expected}", ", ".join(named) or "none of them")
