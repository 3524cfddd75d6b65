"""``assumptions``: the reply names what it assumed, and the scenario agrees."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim_evals.grader.claims import claims
from irsim_evals.grader.matching import Match, matches
from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material


@register("assumptions")
class Assumptions(AnswerPredicate):
    """Numbers and names in the reply that are those of the scenario, and none that contradict it."""

    number: Match
    """Accepted numbers of claims that hold."""
    contradictions: Match = Match(eq=0)
    """Accepted numbers of claims that do not."""

    def observe(self, material: Material) -> Observation:
        """Hold the reply against the world."""
        found = claims(material.reply, material.scene(0))
        good = [claim.text for claim in found if claim.holds]
        bad = [claim.text for claim in found if claim.holds is False]
        passed = matches(self.number, len(good), "count") and matches(self.contradictions, len(bad), "count")
        observed = f"{len(good)}: {', '.join(good[:6])}" + (f"; not so: {', '.join(bad[:4])}" if bad else "")
        return Observation(passed, f"stated facts that hold: {self.number.words()}, none that do not", observed)
