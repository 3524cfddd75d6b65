"""``results.json`` of a report: the trials, and beside them the aggregates and the runs in the fields of skill-creator.

``runs`` and ``run_summary`` have the names of its ``benchmark.json``, so that its viewer can read the file;
``expectations`` has the names of its ``grading.json``. ``irsim-evals report`` and ``compare`` read the trials again.
"""

from __future__ import annotations

import json
import math
import statistics
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from irsim.common.text import escape_marks
from irsim_evals.report.comparison import Comparison
from irsim_evals.report.content import Content
from irsim_evals.report.summary import ArmSummary, Table
from irsim_evals.results import Trial
from irsim_evals.statistics import Interval

__all__ = ["aggregates", "as_benchmark", "comparison_data", "plain"]


def as_benchmark(content: Content) -> str:
    """The file as text."""
    trials = content.results.trials
    data = {
        **content.results.model_dump(mode="json"),
        "aggregates": aggregates(content),
        "metadata": {
            "skill_name": content.title,
            "executor_model": ", ".join(dict.fromkeys(t.model for t in trials if t.model)) or None,
            "evals_run": sorted({trial.verdict.name for trial in trials}),
            "runs_per_configuration": max(trial.number for trial in trials),
        },
        "runs": [_run(trial) for trial in trials],
        "run_summary": {one.arm: _run_summary([t for t in trials if t.arm == one.arm]) for one in content.arms},
        "notes": [text for one in content.comparisons for text in one.sentences],
    }
    return escape_marks(json.dumps(plain(data), indent=1, ensure_ascii=False)) + "\n"


def aggregates(content: Content) -> dict[str, Any]:
    """The numbers of the report."""
    names = [arm.arm for arm in content.arms]
    return {
        "arms": {arm.arm: _arm(arm) for arm in content.arms},
        "categories": _table(content.categories, names),
        "levels": _table(content.levels, names),
        "comparisons": [comparison_data(one) for one in content.comparisons],
        "failures": content.failures,
        "proof": content.proof
        and [{"what": name, "wrong": wrong, **share._asdict()} for name, wrong, share in content.proof.totals()],
    }


def comparison_data(one: Comparison) -> dict[str, Any]:
    """A comparison as JSON: what it holds, and what it says."""
    said = {"means_something": one.means_something, "sentence": one.sentence, "sentences": one.sentences}
    result: dict[str, Any] = plain(asdict(one) | said)
    return result


def plain(value: Any) -> Any:
    """A value in which intervals have names, and numbers that JSON cannot say are null."""
    if isinstance(value, Interval):
        return plain(value._asdict())
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _arm(arm: ArmSummary) -> dict[str, Any]:
    return {
        "models": arm.models, "cases": arm.cases, "trials": arm.trials.total, "passed": arm.trials.passed,
        "strict": arm.strict, "rate": arm.rate, "funnel": {stage: cell.passed for stage, cell in arm.funnel.items()},
        "pass_hat": {str(k): value for k, value in arm.pass_hat.items()},
        "cost_known": arm.cost.known, "cost": arm.cost.totals, "cost_per_pass": arm.cost.per_pass,
    }  # fmt: skip


def _table(table: Table, arms: Sequence[str]) -> dict[str, dict[str, dict[str, int]]]:
    return {name: {arm: asdict(cell) for arm, cell in zip(arms, cells, strict=True)} for name, cells in table}


def _run(trial: Trial) -> dict[str, Any]:
    """One attempt, as skill-creator writes it."""
    verdict, cost = trial.verdict, trial.verdict.cost
    passed, total = sum(one.passed for one in verdict.outcomes), len(verdict.outcomes)
    return {
        "eval_id": verdict.name, "eval_name": trial.title, "configuration": trial.arm, "run_number": trial.number,
        "result": {
            "pass_rate": verdict.rate, "passed": passed, "failed": total - passed, "total": total,
            "time_seconds": cost.seconds, "tokens": cost.tokens, "tool_calls": cost.calls, "errors": cost.errors,
        },
        "expectations": [
            {"text": f"{one.assertion}: {one.expected}", "passed": one.passed, "evidence": one.observed}
            for one in verdict.outcomes
        ],
    }  # fmt: skip


def _run_summary(trials: Sequence[Trial]) -> dict[str, Any]:
    costs = [trial.verdict.cost for trial in trials]
    quantities = {
        "pass_rate": [trial.verdict.rate for trial in trials],
        "time_seconds": [cost.seconds for cost in costs if cost.seconds is not None],
        "tokens": [float(cost.tokens) for cost in costs if cost.tokens is not None],
    }
    return {name: _spread(values) for name, values in quantities.items() if values}


def _spread(values: Sequence[float]) -> dict[str, float]:
    deviation = statistics.stdev(values) if len(values) > 1 else 0.0
    return {"mean": statistics.fmean(values), "stddev": deviation, "min": min(values), "max": max(values)}
