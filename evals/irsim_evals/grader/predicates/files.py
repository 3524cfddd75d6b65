"""``files``: which files the agent leaves."""

from __future__ import annotations

import fnmatch
import re
from typing import TYPE_CHECKING

from irsim_evals.grader.matching import Match, matches
from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material


@register("files")
class Files(AnswerPredicate):
    """How many files of a pattern there are, and what the text of each contains."""

    pattern: str
    """Such as ``*.py``."""
    number: Match
    """Accepted numbers of files, those that were given left out."""
    contain: list[str] = []
    """Regular expressions that each of them contains."""
    lack: list[str] = []
    """Regular expressions that none of them contains."""

    def observe(self, material: Material) -> Observation:
        """Look into the folder."""
        names = [
            name
            for name in material.texts
            if fnmatch.fnmatch(name, self.pattern) and material.given.get(name) != material.texts[name]
        ]
        wrong = []
        for name in names:
            wrong += [f"{name} lacks /{p}/" for p in self.contain if not re.search(p, material.texts[name])]
            wrong += [f"{name} contains /{p}/" for p in self.lack if re.search(p, material.texts[name])]
        passed = matches(self.number, len(names), "count") and not wrong
        return Observation(
            passed,
            f"{self.pattern}: {self.number.words()}",
            "; ".join([f"{len(names)}: {', '.join(names[:6])}", *wrong[:3]]),
        )
