"""The audit of one recorded run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from shapely.errors import ShapelyError

from irsim.common.text import clean
from irsim.results.audit import AuditResult, RunAudit
from irsim.results.findings import Finding
from irsim.runs.audit.artifact import read_artifact
from irsim.runs.audit.compare_contacts import compare_contacts
from irsim.runs.audit.compare_motion import compare_limits, compare_motion
from irsim.runs.audit.compare_outcome import audited_robots, compare_arrivals, compare_result
from irsim.runs.audit.contacts import Encounters
from irsim.runs.audit.report import Report
from irsim.runs.audit.shapes import TOLERANCE_M, Shape
from irsim.runs.audit.strides import Strides
from irsim.runs.files import RunError

__all__ = ["audit_run", "audit_runs"]

_RECORD_AGAIN = "record the run again: the same scenario and seed give the same run"


def audit_runs(runs: Sequence[str | Path]) -> AuditResult:
    """Audit several recorded runs; one that cannot be read has that as its finding.

    Args:
        runs: Each an id of a run, its folder, one of its files, or ``last``.
    """
    results = [_safely(run) for run in runs]
    odd = sum(not result.equal for result in results)
    if len(results) == 1:
        summary = results[0].summary
    else:
        summary = f"{len(results) - odd} of {len(results)} runs are equal to what is recomputed from them"
    return AuditResult(equal=not odd, summary=summary, runs=results)


def _safely(run: str | Path) -> RunAudit:
    try:
        return audit_run(run)
    except RunError as error:
        code, message, fix = error.code, error.message, error.fix or _RECORD_AGAIN
    except (ValueError, ArithmeticError, LookupError, TypeError, MemoryError, ShapelyError) as error:
        # numbers and outlines of strangers: each file is of the right form, and yet no world has them
        code, fix = "unreadable-run", _RECORD_AGAIN
        message = f"nothing can be computed from its numbers ({clean(str(error) or type(error).__name__, 100)})"
    name = clean(str(run), 200)
    message = clean(message, 400)
    problem = Finding(code=code, severity="error", path=name, line=None, column=None, message=message, fix=fix)
    return RunAudit(run=name, equal=False, summary=f"{name}: {message}", problems=[problem])


def audit_run(run: str | Path) -> RunAudit:
    """Recompute contacts, limits, arrivals, outcome and the main metrics of a recorded run, and compare them.

    Only the files of the run are read, and nothing of the engine runs.

    Args:
        run: Id of the run, its folder, one of its files, or ``last``.

    Raises:
        RunError: There is no such run, or it cannot be read.
    """
    artifact, report = read_artifact(run), Report()
    with np.errstate(all="ignore"):
        shapes = [Shape(body.drawn.outlines, artifact.cells) for body in artifact.bodies]
        strides = Strides(artifact)
        compare_motion(artifact, strides, report)
        compare_limits(artifact, report)
        if all(shape.is_known for shape in shapes):
            compare_contacts(artifact, Encounters(artifact, strides, shapes), report)
        else:
            report.skip("contacts", "the cells of the map are not in the record: they were too many")
        compare_arrivals(artifact, report)
        robots = audited_robots(artifact, shapes)
        outcome: Any = compare_result(artifact, robots, report)
    return RunAudit(
        run=str(run),
        equal=not report.count,
        summary=_summary(str(run), artifact.last, len(artifact.bodies), report),
        outcome=outcome if robots else None,
        steps=artifact.last,
        objects=len(artifact.bodies),
        checks=report.checks,
        findings=report.findings,
        finding_count=report.count,
        within_tolerance=report.near,
        within_tolerance_count=report.near_count,
        tolerance=TOLERANCE_M,
        unseen_depth=report.depth,
        robots=robots,
        version=artifact.meta.irsim,
    )


def _summary(run: str, steps: int, objects: int, report: Report) -> str:
    what = f"{steps} steps of {objects} objects"
    near = f"; {report.near_count} contacts are within the tolerance of touching" if report.near_count else ""
    if not report.count:
        return f"{run}: equal: {what}, {sum(check.compared for check in report.checks)} comparisons{near}"
    return f"{run}: {report.count} differences in {what}; the first: {report.findings[0].message}{near}"
