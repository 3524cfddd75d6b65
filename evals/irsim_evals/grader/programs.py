"""The programs of an answer: which there are, whether they only run scenarios, and what they print."""

from __future__ import annotations

import ast
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from irsim.common.child import kill_group
from irsim_evals.grader.run_program import Started, read_log

__all__ = [
    "ALLOWED_MODULES", "SECONDS", "Printed", "is_program", "problems_in", "problems_of", "rehearse_program",
    "run_program",
]  # fmt: skip

SECONDS = 40.0
"""Processor time that one program gets [s]."""
_PATIENCE = 4.0
"""Time on the clock after which it is ended, as a multiple of its processor time."""
_OUT_OF_TIME = tuple(-int(getattr(signal, name)) for name in ("SIGKILL", "SIGXCPU") if hasattr(signal, name))
"""Exit codes of a program that has used up its processor time."""
_MAX_PRINTED = 200_000
"""Number of characters of the output that are kept."""
_PROGRAMS = (".py", ".ipynb", ".sh", ".js", ".pl", ".rb", ".bat", ".ps1")
ALLOWED_MODULES = frozenset([
    "__future__", "argparse", "collections", "csv", "dataclasses", "functools", "irsim", "itertools", "json",
    "math", "numpy", "pathlib", "random", "statistics", "sys", "time", "typing", "yaml",
])  # fmt: skip
"""Modules that it may import; what lies below them, too."""
_FORBIDDEN_NAMES = frozenset([
    "__import__", "breakpoint", "compile", "delattr", "eval", "exec", "getattr", "globals", "input", "locals",
    "setattr", "vars",
])  # fmt: skip
"""Built-in functions with which a program could get round these rules."""
_FORBIDDEN = {
    "a runner registers no code of its own: behaviors and drives belong in the YAML":
        "register_behavior register_group_behavior register_behavior_class register_kinematics register",
    "a runner does not place objects: poses and goals belong in the YAML":
        "set_state set_goal create_object create_robot create_obstacle add_object add_objects",
    "a runner needs no other modules":
        "os subprocess socket shutil ctypes ctypeslib importlib builtins signal multiprocessing threading modules "
        "unsafe_load UnsafeLoader Loader CLoader",
    "a runner does not change files other than its results":
        "unlink rmdir rename symlink_to hardlink_to chmod loads_pickle load_library",
}  # fmt: skip
"""Reason → attributes that a program may not use."""
_FORBIDDEN_ATTRIBUTES = {name: why for why, names in _FORBIDDEN.items() for name in names.split()}


@dataclass(frozen=True)
class Printed:
    """The run of a program.

    Attributes:
        passed: Whether it ended by itself, and without an error.
        text: Its output.
        why: Why it did not pass.
        episodes: The episodes that it started in a rehearsal.
    """

    passed: bool
    text: str
    why: str = ""
    episodes: Sequence[Started] = ()


def is_program(name: str, text: str | None = None) -> bool:
    """Whether a file is a program, by its name or its first line."""
    return name.lower().endswith(_PROGRAMS) or (text or "").startswith("#!")


def problems_in(texts: Mapping[str, str | None], given: Mapping[str, str], allowed: str) -> list[str]:
    """Problems of the programs of an answer.

    Args:
        texts: Files of the answer; None for a file that is not text.
        given: Files that it started with.
        allowed: ``none`` or ``runner``.
    """
    names = [
        name for name, text in texts.items() if is_program(name, text) and (text is None or given.get(name) != text)
    ]
    if allowed == "none":
        return [f"{name} is a program" for name in names]
    problems = []
    for name in names:
        text = texts[name]
        if text is None or not name.endswith(".py"):
            problems.append(f"{name} is not a Python program")
        else:
            problems += [f"{name}, {problem}" for problem in problems_of(text)]
    return problems


def rehearse_program(folder: Path, name: str, seconds: float = SECONDS) -> Printed:
    """Run a program as :func:`run_program` does, but simulate nothing, and find out which episodes it starts."""
    with tempfile.TemporaryDirectory(prefix="irsim-evals-") as outside:  # where the program may not write
        return run_program(folder, name, seconds, Path(outside, "episodes.jsonl"))


def run_program(folder: Path, name: str, seconds: float = SECONDS, log: Path | None = None) -> Printed:
    """Run a program in a folder, in processes that end with it.

    Args:
        folder: Folder with the files of the answer.
        name: Path of the program in it.
        seconds: Processor time after which it is ended [s].
        log: File for the episodes that it starts, if it is rehearsed.
    """
    command = _command(name, str(seconds), *([str(log)] if log else []))
    environment = {"PATH": os.defpath, "MPLBACKEND": "Agg", "HOME": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    with (folder / ".printed").open("wb") as output:
        process = subprocess.Popen(
            command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
            start_new_session=True,
        )  # fmt: skip
        try:
            code: int | None = process.wait(_PATIENCE * seconds)
        except subprocess.TimeoutExpired:
            code = None
        finally:
            kill_group(process.pid)
            process.wait()
    with (folder / ".printed").open("rb") as printed:
        text = printed.read(_MAX_PRINTED).decode("utf-8", errors="replace")
    episodes = read_log(log) if log else []
    if code in (None, *_OUT_OF_TIME):
        return Printed(False, text, f"{name} did not end within {seconds:g} s", episodes=episodes)
    if code != 0:
        lines = text.strip().splitlines()
        why = f"{name} ended with exit code {code}: {lines[-1] if lines else ''}"[:300]
        return Printed(False, text, why, episodes=episodes)
    return Printed(True, text, episodes=episodes)


def _command(*arguments: str) -> list[str]:
    return [sys.executable, "-I", "-m", "irsim_evals.grader.run_program", *arguments]


def problems_of(text: str) -> list[str]:
    """Things a program does that a runner of scenarios may not do, each with its line; empty if it is one."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        return [f"it is not Python: {error}"]
    problems: list[str] = []
    for node in ast.walk(tree):
        why = _problem(node)
        if why:
            problems.append(f"line {getattr(node, 'lineno', 1)}: {why}")
    return problems


def _problem(node: ast.AST) -> str:
    if isinstance(node, ast.Import):
        return _imports([alias.name for alias in node.names])
    if isinstance(node, ast.ImportFrom):
        if node.level:
            return "it imports a module beside it"
        return _imports([node.module or ""]) or next(
            (_FORBIDDEN_ATTRIBUTES[alias.name] for alias in node.names if alias.name in _FORBIDDEN_ATTRIBUTES), ""
        )
    if isinstance(node, ast.Name) and node.id in _FORBIDDEN_NAMES:
        return f"it uses {node.id}"
    if isinstance(node, ast.Attribute):
        if node.attr.startswith("__"):
            return f"it uses {node.attr}"
        return _FORBIDDEN_ATTRIBUTES.get(node.attr, "")
    return ""


def _imports(names: list[str]) -> str:
    odd = [name for name in names if name.partition(".")[0] not in ALLOWED_MODULES]
    return f"it imports {', '.join(odd)}" if odd else ""
