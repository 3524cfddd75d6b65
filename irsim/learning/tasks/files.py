"""Reads and checks task files, and registers the bundled tasks with Gymnasium."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic, format_path, nearest, suggestion
from irsim.diagnostics.diagnostic import Path as Path_
from irsim.diagnostics.errors import CodedError
from irsim.diagnostics.report import format_diagnostics
from irsim.learning.tasks.task import Task
from irsim.scenario.file_kind import FileKind
from irsim.scenario.locate import near_files
from irsim.scenario.yaml.document import Document, load_data, load_path

__all__ = ["TASKS", "TaskError", "TaskSource", "environment_id", "open_task", "register_environments", "task_error"]

TaskSource = str | os.PathLike[str] | Mapping[str, Any] | Task
"""A task, its data, the path of its file, or the name of a bundled task."""


class TaskError(CodedError, ValueError):
    """A task cannot be used; the message lists every problem."""

    def __init__(self, message: str, fix: str, diagnostics: Sequence[Diagnostic] = ()) -> None:
        self.diagnostics = list(diagnostics)
        super().__init__("bad-task", message, fix)


def task_error(path: Path_, message: str, fix: str) -> TaskError:
    """The error about one key of a task.

    Args:
        path: The key.
        message: One sentence.
        fix: The text to write instead.
    """
    whole = f"{format_path(path)}: {message}"
    return TaskError(whole, fix, [Diagnostic("invalid-value", "error", path, message, fix=fix)])


def open_task(source: TaskSource) -> tuple[Task, Path]:
    """A task, and the folder relative to which it names files.

    Args:
        source: A task, its data, the path of its file, or the name of a bundled task.

    Raises:
        TaskError: There is no such file, or it is not valid.
    """
    if isinstance(source, Task):
        return source, Path()
    if isinstance(source, Mapping):
        return TASKS.read(load_data(source, "task")), Path()
    path, known = Path(source), TASKS.names()
    if not path.is_file() and str(source) in known:
        path = TASKS.bundled(str(source))
    if not path.is_file():
        bundled = not path.suffix and nearest(str(source), known) is not None
        files = [] if bundled else near_files(str(source), [str(path.parent)])
        fix = f"did you mean {clean(files[0])}?" if files else None
        fix = fix or suggestion(str(source), known, f"give a task file, or one of {', '.join(known)}")
        raise TaskError(f"there is no task file {clean(str(source), 200)!r}", fix)
    return TASKS.read(load_path(path)), path.parent


def _error(document: Document, problems: Sequence[Diagnostic]) -> TaskError:
    name = clean(document.name or "the task", 200)
    if {one.path[0] for one in problems if one.code == "unknown-key"} >= {"world", "robot"}:
        what = f"{name} is a scenario, and a task adds to one what learning needs: an observation and a reward"
        wanted = f"write a task with 'file: {name}' in place of its scenario"
        return TaskError(what, f"{wanted}: irsim describe task.goal_lidar has one to start from", problems)
    text = format_diagnostics(problems, document.text)
    return TaskError(f"{name} is not a valid task\n{text}", "`irsim describe task` lists the keys of a task", problems)


TASKS = FileKind(key="task", model=Task, folder=Path(__file__).with_name("bundled"), error=_error)
"""Task files."""

_VERSION = 0


def environment_id(task: str) -> str:
    """The id of a bundled task: ``irsim/GoalLidar-v0`` for ``goal_lidar``."""
    return f"irsim/{''.join(word.capitalize() for word in task.split('_'))}-v{_VERSION}"


def register_environments() -> None:
    """Register the bundled tasks, and ``irsim/Task-v0`` with the argument ``task``; nothing without Gymnasium."""
    if find_spec("gymnasium") is None:
        return
    import gymnasium  # an import of what only some have installed

    entries = {"entry_point": "irsim.learning.gym_env:Env", "vector_entry_point": "irsim.learning.vector_env:VectorEnv"}
    known = gymnasium.registry
    for task in TASKS.names():
        if environment_id(task) not in known:
            gymnasium.register(environment_id(task), kwargs={"task": str(TASKS.bundled(task))}, **entries)
    if (general := f"irsim/Task-v{_VERSION}") not in known:
        gymnasium.register(general, **entries)
