"""The reports of ``irsim validate`` on files beside scenarios: suites and tasks."""

from __future__ import annotations

from dataclasses import replace

from irsim.benchmarks.suite import SuiteError, load_suite
from irsim.benchmarks.suite_plan import suite_plan
from irsim.common.text import plural
from irsim.diagnostics.diagnostic import Diagnostic
from irsim.diagnostics.errors import ScenarioError
from irsim.learning.draws import check_observed
from irsim.learning.tasks.files import TaskError, open_task
from irsim.learning.tasks.scene import open_scene
from irsim.learning.tasks.team import team_of
from irsim.results.validation import ValidationReport
from irsim.scenario.messages.translate import located
from irsim.scenario.yaml.document import load_path
from irsim.validation.suite_checks import suite_warnings
from irsim.validation.validate import report

__all__ = ["suite_report", "task_report"]


def suite_report(word: str) -> ValidationReport:
    """Check a suite and every scenario that it expands to, without running it.

    Args:
        word: Name of a bundled suite, or path of a suite file.
    """
    try:
        suite, file = load_suite(word)
        plan = suite_plan(word)
        warnings = suite_warnings(suite, file)
    except SuiteError as error:
        return report(word, [_of_this_file(item, word) for item in error.diagnostics] or [_whole(error)])
    size = f"{len(plan.scenarios)} scenarios x {len(plan.policies)} policies x {len(plan.seeds)} seeds"
    own = [replace(item, file=None) if item.file == str(file) else _of_this_file(item, word) for item in warnings]
    return report(word, own, f"suite {suite.suite}, {size}")


def task_report(file: str) -> ValidationReport:
    """Check a task file and its scenario, without running it.

    Args:
        file: Path of the file.
    """
    try:
        task, folder = open_task(file)
        scene = open_scene(task, folder)
        team = team_of(task, scene.scenario)
        check_observed(task, scene)
    except TaskError as error:
        document = load_path(file)
        return report(file, [located(item, document) for item in error.diagnostics] or [_whole(error)])
    except ScenarioError as error:
        return report(file, [_of_scenario(item) for item in error.diagnostics if item.severity == "error"])
    words = [f"{plural(len(team.names), 'learner')} ({team.drive})"]
    variation = scene.scenario.variation
    if variation is not None and variation.variants:
        words.append(f"{len(variation.variants)} variants")
    if task.curriculum is not None:
        words.append(f"{len(task.levels)} levels")
    return report(file, [_of_scenario(item) for item in scene.warnings], f"task {task.task}, {', '.join(words)}")


def _whole(error: SuiteError | TaskError) -> Diagnostic:
    """The problem of a file that is not one of a key."""
    return Diagnostic("invalid-value", "error", (), error.message, fix=error.fix)


def _of_this_file(item: Diagnostic, word: str) -> Diagnostic:
    """A problem with its place in the suite file; one of another file names that file in its message."""
    if item.file in (None, word):
        return item
    line = "" if item.line is None else f", line {item.line}"
    return replace(item, message=f"{item.file}{line}: {item.message}", line=None, column=None, length=1)


def _of_scenario(item: Diagnostic) -> Diagnostic:
    """A problem of the scenario of a task."""
    return replace(item, path=("scenario", *item.path), line=None, column=None, length=1, edit=None)
