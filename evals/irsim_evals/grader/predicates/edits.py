"""``edits``: what was changed in the file that the agent was given, and what was kept."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import yaml
from pydantic import Field

from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register

if TYPE_CHECKING:
    from irsim.results.diff import ScenarioDiff
    from irsim_evals.grader.material import Material


@register("edits")
class Edits(AnswerPredicate):
    """What differs between the file that was given and the file that was left: by key, and in the world it makes."""

    stage = "edits"

    base: str = "scenario.yaml"
    """The file that was given."""
    file: str | None = None
    """The file that was left; default: the scenario of the answer."""
    only: list[str] | None = None
    """Paths that may change: ``robot[0].sensors[0].range_max``; what lies below one may change, too. ``*`` stands for
    any index. A path with ``world:`` before it names a fact of the world instead of a key, as ``irsim diff`` does."""
    must: dict[str, Match] = {}
    """Path → accepted new values."""
    lines: Match | None = None
    """Accepted numbers of changed lines; removed and added lines count once each, a replaced line twice."""
    keeps_comments: bool | None = None
    """Whether every comment must still be there."""
    same: bool | None = None
    """Whether nothing at all may differ."""
    not_left: list[str] = Field(default_factory=list)
    """Regular expressions that no line of the new file may contain."""

    def observe(self, material: Material) -> Observation:
        """Compare the files."""
        before, after = material.given.get(self.base), material.texts.get(self.file or material.main or "")
        expected = self._words()
        if before is None or after is None:
            return Observation(False, expected, "there is nothing to compare")
        diff = compared(before, after)
        wrong: list[str] = []
        where = None
        if self.only is not None:
            odd = [change.path for change in diff.keys if change.change != "moved" and not self._allowed(change.path)]
            wrong += [f"{path} differs, too" for path in odd]
            where = odd[0] if odd else None
        if self.same is not None and diff.same != self.same:
            wrong.append("they differ" if not diff.same else "nothing differs")
        data = yaml.safe_load(after)
        for path, match in self.must.items():
            value = value_at(data, path)
            if not matches(match, value, "size"):
                wrong.append(f"{path} is {show(value)}")
                where = where or path
        if self.lines is not None:
            changed = diff.lines_removed + diff.lines_added
            if not matches(self.lines, changed, "count"):
                wrong.append(f"{changed} lines were changed")
        if self.keeps_comments and diff.comments_lost:
            wrong.append(f"the comment {diff.comments_lost[0]!r} is gone")
        for pattern in self.not_left:
            if re.search(pattern, after):
                wrong.append(f"it still holds {pattern!r}")
        return Observation(not wrong, expected, "; ".join(wrong[:4]) if wrong else diff.summary, where)

    def _words(self) -> str:
        parts = []
        if self.only is not None:
            parts.append("only " + ", ".join(self.only) + " differs" if self.only else "nothing else differs")
        parts += [f"{path} becomes {match.words()}" for path, match in self.must.items()]
        if self.lines is not None:
            parts.append(f"changed lines: {self.lines.words()}")
        if self.keeps_comments:
            parts.append("every comment is kept")
        if self.same is not None:
            parts.append("the file is as it was" if self.same else "the file has changed")
        parts += [f"no {pattern!r} is left" for pattern in self.not_left]
        return ", ".join(parts)

    def _allowed(self, path: str) -> bool:
        return any(_covers(allowed, path) for allowed in self.only or [])


def compared(before: str, after: str) -> ScenarioDiff:
    """How two scenario texts differ."""
    from irsim.scenario.read import read
    from irsim.scenario.yaml.document import load_text
    from irsim.validation.diff.compare import compare

    return compare(read(load_text(before), strict=False), read(load_text(after), strict=False), seed=0)


def _covers(allowed: str, path: str) -> bool:
    pattern = re.escape(allowed).replace(r"\*", r"\d+")
    return re.fullmatch(rf"{pattern}(?:[.\[].*)?", path) is not None


def value_at(data: Any, path: str) -> Any:
    """The value at a path such as ``robot[0].sensors[1].number``; None if there is none. One entry may be written
    with or without a list around it."""
    for name, index in re.findall(r"([^.\[\]]+)|\[(\d+)\]", path):
        if name:
            if isinstance(data, list) and len(data) == 1:
                data = data[0]
            data = data.get(name) if isinstance(data, dict) else None
        elif isinstance(data, list):
            data = data[int(index)] if int(index) < len(data) else None
        elif int(index) != 0:
            data = None
    return data
