"""``report.md``: the report in a few lines, for a pull request."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from irsim_evals.report.content import Content, tables
from irsim_evals.report.failures import category_of
from irsim_evals.report.html_text import one_line, percent
from irsim_evals.report.summary import ArmSummary, Cell
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
        _table(["arm", "cases", "strict pass", "95 %", "requirements met", "95 %"], map(_arm, content.arms)),
        "Intervals are Wilson's at 95 %, with each case as one observation.",
        *(_safe(" ".join(one.sentences), 900) for one in content.comparisons),
    ]
    for section in tables(content):
        parts += [f"## {section.title}", _table(section.heads, section.rows)]
    if content.proof is not None:
        rows = [
            [name, str(wrong), f"{share.estimate:.2%}", f"{share.high:.2%}"]
            for name, wrong, share in content.proof.totals()
        ]
        parts += ["## Proof of the grader", _table(["", "number", "share", "upper bound"], rows)]
    for arm in content.arms:
        failed = [t for t in content.results.trials if t.arm == arm.arm and not t.verdict.strict]
        if failed:
            parts += [f"## Failures of {_safe(arm.arm)}", _failed(failed)]
    return "\n\n".join(parts) + "\n"


def _arm(arm: ArmSummary) -> list[str]:
    shares = [(percent(share), f"{percent(low)} to {percent(high)}") for share, low, high in (arm.strict, arm.rate)]
    return [arm.arm, str(arm.cases), *shares[0], *shares[1]]


def _failed(trials: Sequence[Trial]) -> str:
    lines = []
    for trial in trials[:_MAX_FAILED]:
        one = next(iter(trial.verdict.failed()), None)
        why = f": {_safe(one.assertion)}: expected {_safe(one.expected)}; observed {_safe(one.observed)}" if one else ""
        attempt = f" (attempt {trial.number})" if trial.number > 1 else ""
        kind = category_of(trial.verdict, trial.ended)
        lines.append(f"- {_safe(trial.verdict.name)}{attempt}, {kind}{why}")
    if len(trials) > _MAX_FAILED:
        lines.append(f"- and {len(trials) - _MAX_FAILED} more")
    return "\n".join(lines)


def _table(heads: Sequence[str], rows: Iterable[Sequence[str | Cell]]) -> str:
    lines = [[_safe(head) for head in heads], ["---"] * len(heads), *([_cell(one) for one in row] for row in rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _cell(value: str | Cell) -> str:
    if isinstance(value, str):
        return _safe(value)
    return f"{value.passed} of {value.total}" if value.total else "–"


def _safe(text: str, longest: int = _MAX_TEXT) -> str:
    """A text in one line, in which nothing is markup."""
    shown = text[: longest + 1]
    for sign in "\\`*_[]|~#@$":
        shown = shown.replace(sign, f"\\{sign}")
    return one_line(shown, 2 * longest).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
