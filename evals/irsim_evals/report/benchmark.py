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
        "run_summary": {
            arm.arm: _run_summary([trial for trial in trials if trial.arm == arm.arm]) for arm in content.arms
        },
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
        "proof": None
        if content.proof is None
        else [{"what": name, "wrong": wrong, **share._asdict()} for name, wrong, share in content.proof.totals()],
    }


def comparison_data(one: Comparison) -> dict[str, Any]:
    """A comparison as JSON."""

    def changes(items: Sequence[Any]) -> list[dict[str, Any]]:
        return [
            {"case": c.case, "instance": c.instance, "title": c.title, "before": c.before, "after": c.after,
             "reason": c.reason}
            for c in items
        ]  # fmt: skip

    data = {
        "first": one.first, "second": one.second, "pairs": one.pairs, "passed": list(one.passed),
        "fixed": changes(one.fixed), "broken": changes(one.broken), "missing": one.missing, "new": one.new,
        "p": one.p, "difference": one.difference._asdict(), "smallest_difference": one.smallest,
        "means_something": one.means_something, "sentence": one.sentence, "sentences": one.sentences,
        "costs": [{**asdict(cost), "difference": cost.difference._asdict()} for cost in one.costs],
    }  # fmt: skip
    result: dict[str, Any] = plain(data)
    return result


def plain(value: Any) -> Any:
    """A value in which numbers that JSON cannot say are null."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _arm(arm: ArmSummary) -> dict[str, Any]:
    return {
        "models": arm.models,
        "cases": arm.cases,
        "trials": arm.trials.total,
        "passed": arm.trials.passed,
        "strict": arm.strict._asdict(),
        "rate": arm.rate._asdict(),
        "funnel": {stage: cell.passed for stage, cell in arm.funnel.items()},
        "pass_hat": {str(k): value for k, value in arm.pass_hat.items()},
        "cost_known": arm.cost.known,
        "cost": arm.cost.totals,
        "cost_per_pass": arm.cost.per_pass,
    }


def _table(table: Table, arms: Sequence[str]) -> dict[str, dict[str, dict[str, int]]]:
    return {
        name: {arm: {"passed": c.passed, "total": c.total} for arm, c in zip(arms, cells, strict=True)}
        for name, cells in table
    }


def _run(trial: Trial) -> dict[str, Any]:
    """One attempt, as skill-creator writes it."""
    verdict = trial.verdict
    passed = sum(one.passed for one in verdict.outcomes)
    return {
        "eval_id": trial.verdict.name,
        "eval_name": trial.title,
        "configuration": trial.arm,
        "run_number": trial.number,
        "result": {
            "pass_rate": verdict.rate,
            "passed": passed,
            "failed": len(verdict.outcomes) - passed,
            "total": len(verdict.outcomes),
            "time_seconds": verdict.cost.seconds,
            "tokens": verdict.cost.tokens,
            "tool_calls": verdict.cost.calls,
            "errors": verdict.cost.errors,
        },
        "expectations": [
            {"text": f"{one.assertion}: {one.expected}", "passed": one.passed, "evidence": one.observed}
            for one in verdict.outcomes
        ],
    }


def _run_summary(trials: Sequence[Trial]) -> dict[str, Any]:
    quantities = {
        "pass_rate": [t.verdict.rate for t in trials],
        "time_seconds": [t.verdict.cost.seconds for t in trials if t.verdict.cost.seconds is not None],
        "tokens": [float(t.verdict.cost.tokens) for t in trials if t.verdict.cost.tokens is not None],
    }
    return {name: _spread(values) for name, values in quantities.items() if values}


def _spread(values: Sequence[float]) -> dict[str, float]:
    deviation = statistics.stdev(values) if len(values) > 1 else 0.0
    return {"mean": statistics.fmean(values), "stddev": deviation, "min": min(values), "max": max(values)}
