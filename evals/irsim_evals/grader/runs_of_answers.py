"""The episodes that an answer runs: its programs start them, or its commands would."""

from __future__ import annotations

import ast
import fnmatch
import re
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from irsim.benchmarks import DEFAULT_SEEDS
from irsim.benchmarks.seeds import seeds_from
from irsim.diagnostics.errors import IrsimError
from irsim.scenario.behavior_override import parse_behavior, split_behaviors
from irsim_evals.grader.programs import problems_of, rehearse_program
from irsim_evals.grader.run_program import Started

if TYPE_CHECKING:
    from pathlib import Path

    from irsim_evals.grader.material import Material

__all__ = ["Runs", "runs_of"]

_COMMAND = re.compile(r"^(?P<before>.*?)\birsim\s+benchmark\s(?P<words>[^\n`]*)", re.MULTILINE)
_NEGATED = re.compile(r"\b(not|never|don.t|instead of|avoid|without|nor)\b|^\s*#(?!\s*\$)", re.IGNORECASE)
"""Words before a command that is not meant to be run."""
_HIDDEN = re.compile(r"<!--.*?-->", re.DOTALL)
_PYTHON = re.compile(r"```python[^\n`]*\n(.*?)```", re.DOTALL)
_FLAGS = ("--json", "--csv", "--strict", "--full", "--resume")
"""Options without a value."""
_MAX_RESULT_BYTES = 1_000_000


@dataclass(frozen=True)
class Runs:
    """The episodes that an answer runs.

    Attributes:
        by: Who runs them, for people: the name of a program, or ``the command``.
        started: The episodes; none where the answer only tells of them.
        words: Output of a program and the files that it writes, and its code without comments unless it prints and
            writes nothing; or else the commands and the reply.
    """

    by: str
    started: Sequence[Started]
    words: str


def runs_of(material: Material, behaviors: set[str], seconds: float) -> Runs | str:
    """The episodes that an answer runs, or the problem that keeps it from running them.

    A program decides if it starts episodes, else commands do that are written in other files or the reply.

    Args:
        material: The answer.
        behaviors: Behaviors that count.
        seconds: Time that the rehearsal of each program gets [s].
    """
    programs = _programs(material)
    idle = ""
    for name in sorted(programs):
        before = _contents(material.folder())
        done = rehearse_program(material.folder(), name, seconds)
        if not done.passed:
            return done.why
        if any(behaviors.intersection(one.behaviors) for one in done.episodes):
            after = _contents(material.folder())
            written = [text for path, text in after.items() if before.get(path) != text]
            counted = [one for one in done.episodes if behaviors.intersection(one.behaviors)]
            said = "\n".join([done.text, *written])
            return Runs(name, counted, f"{said}\n{_code(programs[name])}" if said.strip() else "")
        idle = idle or f"{name} runs no episode under {' or '.join(sorted(behaviors))}"
    others = {name: text for name, text in material.answer.files.items() if name not in (*material.given, *programs)}
    words = _HIDDEN.sub("", "\n".join([*others.values(), material.answer.reply]))
    started = list(_commanded(material, words))
    if idle and not started:
        return idle
    return Runs("the command", started, words)


def _programs(material: Material) -> dict[str, str]:
    """The programs by name; those in the reply are written into the folder where there are no others."""
    programs = {n: t for n, t in material.answer.files.items() if n.endswith(".py") and n not in material.given}
    if programs:
        return programs
    for number, text in enumerate(_PYTHON.findall(material.answer.reply)):
        if "irsim" in text and not problems_of(text):
            programs[f"reply_{number}.py"] = text
            (material.folder() / f"reply_{number}.py").write_text(text, encoding="utf-8", errors="replace")
    return programs


def _code(text: str) -> str:
    """A program without its comments and docstrings."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return text
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [item for item in body if not _is_text(item)] or [ast.Pass()]  # type: ignore[attr-defined]
    return ast.unparse(tree)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _contents(folder: Path) -> Mapping[str, str]:
    """The small texts in a folder."""
    return {
        path.name: path.read_text(encoding="utf-8", errors="replace")
        for path in sorted(folder.iterdir())
        if path.is_file() and not path.is_symlink() and path.name != ".printed"
        and path.suffix != ".py" and path.stat().st_size < _MAX_RESULT_BYTES
    }  # fmt: skip


def _commanded(material: Material, text: str) -> Iterator[Started]:
    """The episodes of commands ``irsim benchmark``; none of a command that cannot be read, or that is warned of."""
    for command in _COMMAND.finditer(text.replace("\\\n", " ")):
        if _NEGATED.search(command["before"]):
            continue
        try:
            words = shlex.split(command["words"], comments=True)
        except ValueError:
            continue
        files, options = _parsed(words)
        try:
            seeds = seeds_from(options.get("--seeds", str(DEFAULT_SEEDS)))
            behaviors = options.get("--policies", options.get("--behaviors", "as-written"))
            names = [_name(word) for word in split_behaviors(behaviors)]
            steps = int(options["--steps"]) if "--steps" in options else None
        except (IrsimError, ValueError):
            continue
        for file in _expanded(files, material.answer.files):
            for name in names:
                used = (name,) if name else _written(material, file)
                yield from (Started(file, used, seed, steps) for seed in seeds)


def _expanded(files: list[str], texts: Mapping[str, str]) -> list[str]:
    """The files that a shell makes of patterns."""
    names: list[str] = []
    for file in files:
        plain = file.removeprefix("./")
        names += sorted(fnmatch.filter(texts, plain)) if re.search(r"[*?\[]", plain) else [plain]
    return names


def _parsed(words: list[str]) -> tuple[list[str], dict[str, str]]:
    """Files and options of a command line."""
    files, options = list[str](), dict[str, str]()
    left = iter(words)
    for word in left:
        name, equals, value = word.partition("=")
        if not word.startswith("-"):
            if word.endswith((".yaml", ".yml", "*")):
                files.append(word)
        elif equals:
            options[name] = value
        elif name not in _FLAGS:
            options[name] = next(left, "")
    return files, options


def _name(behavior: str) -> str:
    """The name of a behavior given as text; empty for the one of the scenario."""
    parsed = parse_behavior(behavior)
    return "" if parsed is None else str(parsed.get("name", ""))


def _written(material: Material, file: str) -> tuple[str, ...]:
    """Names of the behaviors of the robots of a scenario."""
    try:
        one = material.other(file)
    except LookupError:
        return ()
    return tuple(sorted({body.behavior for body in one.scene(0).robots if body.behavior is not None}))
