"""``report.md``: the report in a few lines, for a pull request."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from irsim.common.text import clean
from irsim_evals.report.content import Content
from irsim_evals.report.failures import category_of, failure_rows
from irsim_evals.report.html_text import UNITS, number, percent
from irsim_evals.report.summary import ArmSummary, Cell, Table
from irsim_evals.results import Trial

__all__ = ["markdown"]

_MAX_FAILED = 15
"""Number of failed cases that are listed for an arm."""
_MAX_TEXT = 160
"""Characters of an untrusted text."""


def markdown(content: Content) -> str:
    """The file as text."""
    parts = [
        f"# {_safe(content.title)}",
        _arms(content.arms),
        "Intervals are Wilson's at 95 %, with each case as one observation.",
        *(_safe(" ".join(one.sentences), 900) for one in content.comparisons),
        "## Where answers fail",
        _funnel(content.arms),
        *(
            [
                "## Kinds of failures",
                _rows(["main reason", *map(_safe, content.failures), "which means"], failure_rows(content.failures)),
            ]
            if any(content.failures.values())
            else []
        ),
        "## By category",
        _table(content.categories, content.arms, "category"),
        "## By level",
        _table(content.levels, content.arms, "level"),
    ]
    if content.proof is not None:
        rows = [
            [name, str(wrong), f"{share.estimate:.2%}", f"{share.high:.2%}"]
            for name, wrong, share in content.proof.totals()
        ]
        parts += ["## Proof of the grader", _rows(["", "number", "share", "upper bound"], rows)]
    for arm in content.arms:
        failed = [t for t in content.results.trials if t.arm == arm.arm and not t.verdict.strict]
        if failed:
            parts += [f"## Failures of {_safe(arm.arm)}", _failed(failed)]
    return "\n\n".join(parts) + "\n"


def _arms(arms: Sequence[ArmSummary]) -> str:
    most = max(len(arm.pass_hat) for arm in arms)
    costs = list(dict.fromkeys(name for arm in arms for name in arm.cost.totals))
    heads = ["arm", "cases", "strict pass", "95 %", "requirements met", "95 %"]
    heads += [f"pass^{k}" for k in range(2, most + 1)]
    heads += [f"{UNITS.get(name, _safe(name))} per pass" for name in costs]
    rows = []
    for arm in arms:
        row = [_safe(arm.arm), str(arm.cases)]
        for estimate, low, high in (arm.strict, arm.rate):
            row += [percent(estimate), f"{percent(low)} to {percent(high)}"]
        row += [percent(arm.pass_hat.get(k, math.nan)) for k in range(2, most + 1)]
        row += ["–" if (each := arm.cost.per_pass.get(name)) is None else number(each) for name in costs]
        rows.append(row)
    return _rows(heads, rows)


def _funnel(arms: Sequence[ArmSummary]) -> str:
    stages = list(arms[0].funnel)
    rows = [
        [_safe(arm.arm), str(arm.trials.total), *(str(arm.funnel[stage].passed) for stage in stages)] for arm in arms
    ]
    return _rows(["no failure up to", "answers", *stages], rows)


def _table(table: Table, arms: Sequence[ArmSummary], name: str) -> str:
    def cell(one: Cell) -> str:
        return f"{one.passed} of {one.total}" if one.total else "–"

    rows = [[_safe(row), *(cell(one) for one in cells)] for row, cells in table.rows]
    return _rows([name, *(_safe(arm.arm) for arm in arms)], rows)


def _failed(trials: Sequence[Trial]) -> str:
    lines = []
    for trial in trials[:_MAX_FAILED]:
        one = next((o for o in trial.verdict.failed() if not o.soft), None)
        why = f": {_safe(one.assertion)}: expected {_safe(one.expected)}; observed {_safe(one.observed)}" if one else ""
        attempt = f" (attempt {trial.number})" if trial.number > 1 else ""
        kind = category_of(trial.verdict, trial.ended)
        lines.append(f"- {_safe(trial.verdict.name)}{attempt}, {kind}{why}")
    if len(trials) > _MAX_FAILED:
        lines.append(f"- and {len(trials) - _MAX_FAILED} more")
    return "\n".join(lines)


def _rows(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _safe(text: str, longest: int = _MAX_TEXT) -> str:
    """A text in one line, in which nothing is markup."""
    shown = "".join(" " if c.isspace() else c for c in str(text)[: longest + 1])
    for sign in "\\`*_[]|~#@$":
        shown = shown.replace(sign, f"\\{sign}")
    return clean(shown, 2 * longest).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
