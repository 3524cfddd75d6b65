"""Files that the agent left: values in them, edits, programs, and output of commands; and tools that it called."""

from __future__ import annotations

import fnmatch
import functools
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Field, ValidationInfo

from irsim.cli.app import COMMANDS
from irsim.common.lazy import module_names
from irsim.common.records import ContentError, read_json
from irsim.common.yaml.limits import YamlLimits
from irsim.common.yaml.plain import read_plain_yaml
from irsim.lookup.schema_walk import unknown_key
from irsim.options.base import problem
from irsim.scenario.model.json_schema import json_schema
from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.predicates._base import AnswerPredicate, Observation, register
from irsim_evals.grader.programs import problems_in, run_program
from irsim_evals.grader.words import Regex, unknown

if TYPE_CHECKING:
    from irsim.results.validation import KeyChange, ScenarioDiff
    from irsim_evals.grader.artefact import Call
    from irsim_evals.grader.material import Material

_MAX_SHOWN = 6
"""Number of values that an observation shows."""
_SECONDS = 240.0
"""Time [s] after which a command is ended."""
_MAX_QUOTED = 200
"""Number of characters of an output that an observation quotes."""

_WRITES = "write_*"
"""Names of the tools that write files."""
_MAX_NAMED = 8
"""Number of calls that an observation names."""
_FILES = ("list_files", "read_file", "write_file")
"""Tools of an agent without a server; it calls the command line as ``irsim run``."""


@register("files")
class Files(AnswerPredicate):
    """How many files of a pattern there are, whatever their names and contents, and what the text of each contains.
    Links and empty folders count. A file that is not text, or is too large to be opened, fulfils no condition on its
    text."""

    pattern: str
    """Such as ``*.py``."""
    number: Match = Match(ge=1)
    """Accepted numbers of files; given files are left out."""
    contain: list[Regex] = []
    """Regular expressions that each of them contains."""
    lack: list[Regex] = []
    """Regular expressions that none of them contains."""
    has: dict[str, Match] = {}
    """Path of values in each of them, which is JSON: ``rows[*].success.n``, where ``*`` stands for every entry →
    accepted values. There must be a value; numbers are compared exactly unless a tolerance is given."""

    def observe(self, material: Material) -> Observation:
        """Look into the folder."""
        names = _new_files(material, self.pattern)
        wrong = []
        for name in names:
            text = material.answer.files.get(name)
            if text is None and (self.contain or self.lack or self.has):
                wrong.append(f"{name} is {material.answer.others.get(name, 'no text')}")
                continue
            wrong += [f"{name} lacks /{p}/" for p in self.contain if not re.search(p, text or "")]
            wrong += [f"{name} contains /{p}/" for p in self.lack if re.search(p, text or "")]
            wrong += [f"{name} {problem}" for problem in (_values(text or "", self.has) if self.has else ())]
        passed = matches(self.number, len(names), "count") and not wrong
        seen = "; ".join([f"{len(names)}: {', '.join(names[:6])}", *wrong[:3]])
        return Observation(passed, f"{self.pattern}: {self.number.words()}", seen)


def _new_files(material: Material, pattern: str) -> list[str]:
    """Names of the files that fit a pattern and were not given like this."""
    return [name for name in material.names if fnmatch.fnmatch(name, pattern)]


def _values(text: str, has: dict[str, Match]) -> list[str]:
    """The problems of the values in a text of JSON."""
    try:
        content = read_json(text)
    except ContentError:
        return ["is not JSON"]
    problems = []
    for path, match in has.items():
        values = values_at(content, path)
        if not values or not all(matches(match, value, "count") for value in values):
            more = f" and {len(values) - _MAX_SHOWN} more" if len(values) > _MAX_SHOWN else ""
            problems.append(f"has at {path}: {', '.join(map(show, values[:_MAX_SHOWN])) or 'no value'}{more}")
    return problems


def values_at(data: Any, path: str) -> list[Any]:
    """The values at a path; none where a part of it does not exist."""
    values = [data]
    for name, index in re.findall(r"([^.\[\]]+)|\[(\d+|\*)\]", path):
        if name:
            values = [item[name] for item in values if isinstance(item, dict) and name in item]
        elif index == "*":
            values = [item for entries in values if isinstance(entries, list) for item in entries]
        else:
            values = [item for entries in values if isinstance(entries, list) for item in entries[int(index) :][:1]]
    return values


_language = functools.cache(json_schema)


def _known(path: str, info: ValidationInfo) -> str:
    place, word, keys = unknown_key(_language(), path) or ("", "", [])
    if word and not re.search(rf"\b{re.escape(word)}:", (info.context or {}).get("files", "")):  # a slip to be mended
        raise unknown(f"key of {place or 'a scenario'}", word, keys)
    if odd := re.match(r"(robot|obstacle)\.", path):
        first, each = (path.replace(odd[1], f"{odd[1]}[{which}]", 1) for which in "0*")
        raise problem("invalid-value", f"{path!r} does not say which {odd[1]}", fix=f"write {first}, or {each} for all")
    return path


KeyPath = Annotated[str, AfterValidator(_known)]
"""Path of a key of a scenario."""


@register("edits", "edits")
class Edits(AnswerPredicate):
    """Differences between the file that was given and the file that was left: by key, and in the world it makes."""

    base: str = "scenario.yaml"
    """The file that was given."""
    file: str | None = None
    """The file that was left; default: the scenario of the answer."""
    only: list[KeyPath] | None = None
    """Paths that may change: ``robot[0].sensors[0].range_max``; what lies below one may change, too. ``*`` stands for
    any index, and ``robot[0].vel_max[1]`` is one number of a list that stays as long as it was."""
    must: dict[KeyPath, Match] = {}
    """Path → accepted new values."""
    lines: Match | None = None
    """Accepted numbers of changed lines; removed and added lines count once each, a replaced line twice."""
    keeps_comments: bool | None = None
    """Whether every comment must still be there."""
    same: bool | None = None
    """Whether nothing at all may differ."""
    not_left: list[Regex] = Field(default_factory=list)
    """Regular expressions that no line of the new file may contain."""

    def observe(self, material: Material) -> Observation:
        """Compare the files."""
        before, after = material.given.get(self.base), material.answer.files.get(self.file or material.main or "")
        asked, of, where = dict[str, list[str]](), f"an edit of {self.base}", list[str]()
        if before is None or after is None:
            return Observation(False, of, "there is nothing to compare")
        try:
            data = read_plain_yaml(after, YamlLimits())
        except ContentError as error:
            return Observation(False, of, f"the new file cannot be read: {error.message}")
        diff = compared(before, after)
        if self.only is not None:
            changed = [path for change in diff.keys if change.change != "moved" for path in _places(change)]
            where += [path for path in changed if not any(_covers(allowed, path) for allowed in self.only)]
            words = f"only {', '.join(self.only)} differs" if self.only else "nothing else differs"
            asked[words] = [f"{path} differs, too" for path in where]
        for path, match in self.must.items():
            value = value_at(data, path)
            wrong = [path] * (not matches(match, value, "size"))
            where += wrong
            asked[f"{path} becomes {match.words()}"] = [f"{path} is {show(value)}" for path in wrong]
        if self.lines is not None:
            lines = diff.lines_removed + diff.lines_added
            off = not matches(self.lines, lines, "count")
            asked[f"changed lines: {self.lines.words()}"] = [f"{lines} lines were changed"] * off
        if self.keeps_comments:
            asked["every comment is kept"] = [f"the comment {lost!r} is gone" for lost in diff.comments_lost[:1]]
        if self.same is not None:
            words = "the file is as it was" if self.same else "the file has changed"
            asked[words] = ["nothing differs" if diff.same else "they differ"] * (diff.same != self.same)
        asked |= {f"no {p!r} is left": [f"it still holds {p!r}"] * bool(re.search(p, after)) for p in self.not_left}
        seen = "; ".join([problem for problems in asked.values() for problem in problems][:4])
        return Observation(not seen, ", ".join(asked), seen or diff.summary, where[0] if where else None)


def compared(before: str, after: str) -> ScenarioDiff:
    """How two scenario texts differ."""
    from irsim.scenario.read import read
    from irsim.scenario.yaml.document import load_text
    from irsim.validation.diff.compare import compare

    return compare(read(load_text(before), strict=False), read(load_text(after), strict=False), seed=0)


def _places(change: KeyChange) -> Iterator[str]:
    """The path of a change; of a list that is as long as before, or of one within it, the paths of the new items."""

    def within(path: str, before: Any, after: Any) -> Iterator[str]:
        if isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
            for number, (old, new) in enumerate(zip(before, after, strict=True)):
                if old != new:
                    yield from within(f"{path}[{number}]", old, new)
        else:
            yield path

    return within(change.path, change.before, change.after)


def _covers(allowed: str, path: str) -> bool:
    pattern = re.escape(allowed).replace(r"\*", r"\d+")
    return re.fullmatch(rf"{pattern}(?:[.\[].*)?", path) is not None


def value_at(data: Any, path: str) -> Any:
    """The value at a path such as ``robot[0].sensors[1].number``; None if the path leads nowhere. One entry may be
    written with or without a list around it."""
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


@register("program", "behavior")
class Program(AnswerPredicate):
    """Programs that only run scenarios end without an error and print something."""

    pattern: str = "*.py"
    """Names of the programs; given ones are left out."""
    number: Match = Match(ge=1)
    """Accepted numbers of programs."""
    prints: list[Regex] = []
    """Regular expressions, ignoring case; the outputs of all programs together contain each."""

    def observe(self, material: Material) -> Observation:
        """Run them."""
        names = _new_files(material, self.pattern)
        expected = f"{self.pattern}: {self.number.words()}" + "".join(f", prints /{p}/" for p in self.prints)
        if not matches(self.number, len(names), "count"):
            return Observation(False, expected, f"{len(names)}: {', '.join(names[:6])}")
        problems = problems_in({name: material.answer.files.get(name) for name in names}, {}, "runner")
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


@register("command", "behavior")
class Command(AnswerPredicate):
    """A command succeeds in the folder. It may run programs of the answer, so it is run only where
    ``irsim-evals grade --run-programs`` says so; elsewhere it has not been observed and does not hold."""

    run: str
    """The command: ``python …``, or one of this project, such as ``irsim validate …``."""
    prints: Regex | None = None
    """Regular expression that its standard output contains."""

    def observe(self, material: Material) -> Observation:
        """Run it."""
        expected = f"`{self.run}` succeeds" + (f" and prints /{self.prints}/" if self.prints is not None else "")
        if material.answer.trusted_folder is None:
            return Observation(False, expected, "it was not run; grade with --run-programs if you trust the answer")
        words = shlex.split(self.run)
        command = [sys.executable, *words[1:]] if words[0] == "python" else [sys.executable, "-m", *words]
        try:
            done = subprocess.run(
                command, cwd=material.answer.trusted_folder, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                errors="replace", check=False, timeout=_SECONDS,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return Observation(False, expected, f"it takes more than {_SECONDS:g} s")
        said = (done.stdout if done.returncode == 0 else done.stderr).strip()
        quoted = said if len(said) <= _MAX_QUOTED else f"… {said[-_MAX_QUOTED:]}"
        passed = done.returncode == 0 and (self.prints is None or re.search(self.prints, done.stdout) is not None)
        return Observation(passed, expected, f"exit code {done.returncode}: {quoted}")


def _known_tool(name: str) -> str:
    tools = (*module_names("irsim_mcp.tools"), *_FILES, *(f"irsim {command}" for command in COMMANDS))
    if not any(fnmatch.fnmatchcase(tool, name) for tool in tools):
        raise unknown("tool", name, tools)
    return name


Tool = Annotated[str, AfterValidator(_known_tool)]
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
        counted = [call for call in log if fnmatch.fnmatchcase(call.tool, self.tool)]
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
        writes = [k for k, call in enumerate(log) if fnmatch.fnmatchcase(call.tool, _WRITES) and not call.error]
        if self.when == "always":
            return log
        last = writes[-1] if writes else len(log)
        return log[:last] if self.when == "before_last_write" else log[last + 1 :]

    def _in_order(self, calls: list[Call]) -> bool:
        done = iter(call for call in calls if not call.error)
        return all(any(fnmatch.fnmatchcase(call.tool, name) for call in done) for name in self.order)
