"""The report of ``irsim validate`` on a task file."""

from __future__ import annotations

from dataclasses import replace

from irsim.diagnostics.diagnostic import Diagnostic
from irsim.diagnostics.errors import ScenarioError
from irsim.learning.draws import check_observed
from irsim.learning.tasks.files import TaskError, open_task
from irsim.learning.tasks.scene import open_scene
from irsim.learning.tasks.team import team_of
from irsim.results.findings import Finding
from irsim.results.validation import ValidationReport
from irsim.scenario.messages.translate import located
from irsim.scenario.yaml.document import load_path

__all__ = ["task_report"]


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
        whole = Diagnostic("invalid-value", "error", (), error.message, fix=error.fix)
        document = load_path(file)
        return _report(file, [located(item, document) for item in error.diagnostics] or [whole])
    except ScenarioError as error:
        wrong = [item for item in error.diagnostics if item.severity == "error"]
        return _report(file, [_of_scenario(item) for item in wrong])
    learners = f"{len(team.names)} learner{'s' * (len(team.names) != 1)} ({team.drive})"
    variation = scene.scenario.variation
    if variation is not None and variation.variants:
        learners += f", {len(variation.variants)} variants"
    if task.curriculum is not None:
        learners += f", {len(task.levels)} levels"
    summary = f"valid: task {task.task}, {learners}"
    return _report(file, [_of_scenario(item) for item in scene.warnings], summary)


def _of_scenario(item: Diagnostic) -> Diagnostic:
    """A problem of the scenario of a task."""
    return replace(item, path=("scenario", *item.path), line=None, column=None, length=1, edit=None)


def _report(file: str, found: list[Diagnostic], valid: str | None = None) -> ValidationReport:
    """The report of a file; ``valid`` begins its summary if the task can be used."""
    findings = [Finding.of(item) for item in found]
    warnings = sum(item.severity == "warning" for item in found)
    errors = len(found) - warnings
    counts = f"{warnings} warning{'s' * (warnings != 1)}"
    if valid is None:
        summary = f"{errors} error{'s' * (errors != 1)}, {counts}"
    else:
        summary = f"{valid}; {counts}" if warnings else valid
    return ValidationReport(
        file=file,
        valid=valid is not None,
        summary=summary,
        errors=errors,
        warnings=warnings,
        hints=0,
        findings=findings,
    )
