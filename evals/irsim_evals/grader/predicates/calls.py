"""Tools that the agent called, as the log of its calls tells."""

from __future__ import annotations

from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import AfterValidator

from irsim.cli.app import COMMANDS
from irsim.common.lazy import module_names
from irsim_evals.grader.matching import Match, matches
from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register
from irsim_evals.grader.words import unknown

if TYPE_CHECKING:
    from irsim_evals.grader.artefact import Call
    from irsim_evals.grader.material import Material

_WRITES = "write_*"
"""Names of the tools that write files."""
_MAX_NAMED = 8
"""Number of calls that an observation names."""
_FILES = ("list_files", "read_file", "write_file")
"""Tools of an agent without a server; it calls the command line as ``irsim run``."""


def _known(name: str) -> str:
    tools = (*module_names("irsim_mcp.tools"), *_FILES, *(f"irsim {command}" for command in COMMANDS))
    if not any(fnmatchcase(tool, name) for tool in tools):
        raise unknown("tool", name, tools)
    return name


Tool = Annotated[str, AfterValidator(_known)]
"""Name of a tool, in which ``*`` stands for any characters."""


@register("calls")
class Calls(AnswerPredicate):
    """Tools that the agent called, and whether they refused. An answer without a log of its calls fails."""

    tool: Tool = "*"
    """Name of the tools whose calls count, such as ``run_episode``; ``*`` stands for any characters."""
    when: Literal["always", "before_last_write", "after_last_write"] = "always"
    """Part of the log that counts: all of it, or what lies before or after the last call of a tool that writes a file
    (``write_scenario``, ``write_file``) without being refused."""
    number: Match | None = None
    """Accepted numbers of these calls."""
    refused: Match | None = None
    """Accepted numbers of those among them that were refused or ended with an error."""
    order: list[Tool] = []
    """Names of tools that were called one after the other without being refused; other calls may lie between."""

    def observe(self, material: Material) -> Observation:
        """Read the log."""
        expected = f"calls of {self.tool}" + ("" if self.when == "always" else f" {self.when.replace('_', ' ')}")
        expected += f": {self.number.words()}" if self.number is not None else ""
        expected += f", refused: {self.refused.words()}" if self.refused is not None else ""
        expected += f", in the order {', '.join(self.order)}" if self.order else ""
        if material.answer.calls is None:
            return Observation(False, expected, "there is no log of calls, as irsim-mcp --log-calls writes it")
        log = self._part(material.answer.calls)
        counted = [call for call in log if fnmatchcase(call.tool, self.tool)]
        refused = sum(call.error for call in counted)
        passed = self.number is None or matches(self.number, len(counted), "count")
        passed = passed and (self.refused is None or matches(self.refused, refused, "count"))
        if self.number is None and self.refused is None and not self.order:
            passed = bool(counted)
        names = ", ".join(call.tool + (" (refused)" if call.error else "") for call in counted[-_MAX_NAMED:])
        seen = f"{len(counted)}, refused {refused}: {names or 'none'}"
        return Observation(passed and self._in_order(counted), expected, seen)

    def _part(self, log: tuple[Call, ...]) -> tuple[Call, ...]:
        """The part of the log that counts; without a call that writes a file, all of it lies before one."""
        writes = [k for k, call in enumerate(log) if fnmatchcase(call.tool, _WRITES) and not call.error]
        if self.when == "always":
            return log
        last = writes[-1] if writes else len(log)
        return log[:last] if self.when == "before_last_write" else log[last + 1 :]

    def _in_order(self, calls: list[Call]) -> bool:
        done = iter(call for call in calls if not call.error)
        return all(any(fnmatchcase(call.tool, name) for call in done) for name in self.order)
