"""``program``: programs of the answer run to their end and print what was asked for."""

from __future__ import annotations

import fnmatch
import re
from typing import TYPE_CHECKING

from irsim_evals.grader.matching import Match, matches
from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register
from irsim_evals.grader.programs import problems_in, run_program

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material


@register("program")
class Program(AnswerPredicate):
    """Programs that only run scenarios end without an error and print something."""

    stage = "behavior"

    pattern: str = "*.py"
    """Names of the programs; those that were given are left out."""
    number: Match = Match(ge=1)
    """Accepted numbers of programs."""
    prints: list[str] = []
    """Regular expressions, ignoring case; the outputs of all programs together contain each."""

    def observe(self, material: Material) -> Observation:
        """Run them."""
        names = [
            name
            for name in material.texts
            if fnmatch.fnmatch(name, self.pattern) and material.given.get(name) != material.texts[name]
        ]
        expected = f"{self.pattern}: {self.number.words()}" + "".join(f", prints /{p}/" for p in self.prints)
        if not matches(self.number, len(names), "count"):
            return Observation(False, expected, f"{len(names)}: {', '.join(names[:6])}")
        problems = problems_in({name: material.texts[name] for name in names}, {}, "runner")
        if problems:
            return Observation(False, expected, "; ".join(problems[:3]))
        printed = ""
        for name in names:
            done = run_program(material.folder(), name)
            printed += done.text
            if not done.passed:
                return Observation(False, expected, done.why, name)
        missing = [p for p in self.prints if not re.search(p, printed, re.IGNORECASE)]
        seen = f"no /{missing[0]}/ in: {printed[-200:]}" if missing else printed.strip()[-200:]
        return Observation(not missing, expected, seen)
