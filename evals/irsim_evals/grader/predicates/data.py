"""``data``: values in a file of JSON that the agent left, such as the result of a benchmark."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material

_MAX_SHOWN = 6
"""Number of values that an observation shows."""


@register("data")
class Data(AnswerPredicate):
    """Every value at some paths of a file of JSON is accepted. A path at which there is no value fails."""

    file: str
    """Path of the file in the folder."""
    has: dict[str, Match]
    """Path such as ``rows[*].success.n``, where ``*`` stands for every entry → accepted values; numbers are compared
    exactly unless a tolerance is given."""

    def observe(self, material: Material) -> Observation:
        """Read the file."""
        expected = f"{self.file}: " + ", ".join(f"{path} {match.words()}" for path, match in self.has.items())
        text = material.texts.get(self.file)
        if text is None:
            return Observation(False, expected, "there is no such file")
        try:
            content = json.loads(text)
        except (ValueError, RecursionError):
            return Observation(False, expected, "it is no JSON")
        seen, passed = [], True
        for path, match in self.has.items():
            found = values_at(content, path)
            passed &= bool(found) and all(matches(match, value, "count") for value in found)
            more = len(found) - _MAX_SHOWN
            shown = ", ".join(map(show, found[:_MAX_SHOWN])) or "no value"
            seen.append(f"{path}: {shown}" + (f" and {more} more" if more > 0 else ""))
        return Observation(passed, expected, "; ".join(seen))


def values_at(data: Any, path: str) -> list[Any]:
    """The values at a path; none where a part of it does not exist."""
    found = [data]
    for name, index in re.findall(r"([^.\[\]]+)|\[(\d+|\*)\]", path):
        if name:
            found = [item[name] for item in found if isinstance(item, dict) and name in item]
        elif index == "*":
            found = [item for entries in found if isinstance(entries, list) for item in entries]
        else:
            found = [item for entries in found if isinstance(entries, list) for item in entries[int(index) :][:1]]
    return found
