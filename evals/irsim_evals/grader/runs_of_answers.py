"""The episodes that an answer runs: those that its programs start, or those that its commands would."""

from __future__ import annotations

import ast
import re
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from irsim.benchmarks import DEFAULT_SEEDS
from irsim.benchmarks.seeds import seeds_from
from irsim.diagnostics.errors import IrsimError
from irsim.scenario.behavior_override import parse_behavior, split_behaviors
from irsim_evals.grader.episode_log import Started
from irsim_evals.grader.programs import run_program

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material

__all__ = ["Runs", "runs_of"]

_COMMAND = re.compile(r"\birsim\s+benchmark\s[^\n`]*")
_FLAGS = ("--json", "--csv", "--strict")
"""Options without a value."""


@dataclass(frozen=True)
class Runs:
    """What an answer runs.

    Attributes:
        by: What runs it, for people: the name of a program, or ``the command``.
        started: The episodes.
        whole: Whether these are all of them. A program that is ended early has started only some.
        words: The code without its comments and what it printed, or the commands; the reply and all other texts where
            nothing runs anything.
    """

    by: str
    started: Sequence[Started]
    whole: bool
    words: str


def runs_of(material: Material, behaviors: set[str], seconds: float) -> Runs | str:
    """What an answer runs, or what is wrong with it.

    A program decides if it starts episodes, else commands do that are written anywhere.

    Args:
        material: The answer.
        behaviors: Behaviors that count.
        seconds: Time that each program gets [s].
    """
    for name in sorted(name for name in material.texts if name.endswith(".py") and name not in material.given):
        done = run_program(material.folder(), name, seconds)
        if done.ended and not done.passed:
            return done.why
        counted = [one for one in done.episodes if behaviors.intersection(one.behaviors)]
        if counted:
            whole = done.ended or any(one.horizon is not None for one in counted)  # a benchmark tells all in advance
            return Runs(name, counted, whole, f"{_code(material.texts[name])}\n{done.text}")
    texts = [text for name, text in material.texts.items() if name not in material.given]
    words = "\n".join([*texts, material.reply])
    started = list(_commanded(material, words))
    return Runs("the command", started, True, words)


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


def _commanded(material: Material, text: str) -> Iterator[Started]:
    """The episodes of commands ``irsim benchmark``; none of a command that cannot be read."""
    for found in _COMMAND.finditer(text.replace("\\\n", " ")):
        try:
            words = shlex.split(found[0], comments=True)[2:]
        except ValueError:
            continue
        files, options = _parsed(words)
        try:
            seeds = seeds_from(options.get("--seeds", str(DEFAULT_SEEDS)))
            names = [_name(word) for word in split_behaviors(options.get("--behaviors", "as-written"))]
            steps = int(options["--steps"]) if "--steps" in options else None
        except (IrsimError, ValueError):
            continue
        for file in files:
            for name in names:
                used = (name,) if name else _written(material, file)
                yield from (Started(file.removeprefix("./"), used, seed, steps) for seed in seeds)


def _parsed(words: list[str]) -> tuple[list[str], dict[str, str]]:
    """Files and options of a command line."""
    files, options = list[str](), dict[str, str]()
    left = iter(words)
    for word in left:
        name, equals, value = word.partition("=")
        if not word.startswith("-"):
            if word.endswith((".yaml", ".yml")):
                files.append(word)
        elif equals:
            options[name] = value
        elif name not in _FLAGS:
            options[name] = next(left, "")
    return files, options


def _name(behavior: str) -> str:
    """The name of a behavior given as text; empty for the one of the scenario."""
    found = parse_behavior(behavior)
    return "" if found is None else str(found.get("name", ""))


def _written(material: Material, file: str) -> tuple[str, ...]:
    """Names of the behaviors of the robots of a scenario."""
    from irsim_evals.grader.predicates.every_scenario import opened

    one = opened(material, file) if file in material.texts else ""
    if isinstance(one, str):
        return ()
    return tuple(sorted({body.behavior for body in one.scene(0).robots if body.behavior is not None}))
