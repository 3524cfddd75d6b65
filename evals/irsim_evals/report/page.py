"""The page of a report: one HTML file that works without a network and asks for nothing but itself."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

from irsim.common.pages import one_page
from irsim.common.text import plural
from irsim_evals.report.case_section import case_sections
from irsim_evals.report.content import Content, tables
from irsim_evals.report.html_text import escaped, note, part, percent
from irsim_evals.report.load import Proof
from irsim_evals.report.summary import ArmSummary, Cell
from irsim_evals.statistics import Interval

__all__ = ["page"]

_SOURCES = Path(__file__).with_name("web")
_CHANGED = (
    "These answers were graded with other cases than the installed ones. So changes of given "
    "files are not shown, and the second picture shows each world after 10 s."
)
_MAX_WRONG = 20
"""Number of wrong verdicts of the proof that are listed."""


def page(content: Content) -> str:
    """The page as text."""
    script = (_SOURCES / "report.js").read_text(encoding="utf-8")
    trials = content.results.trials
    parts = {
        "title": escaped(content.title, 120),
        "facts": escaped(
            f"{len({trial.key for trial in trials})} cases, {len(trials)} answers, {plural(len(content.arms), 'arm')}"
            f" · irsim {content.results.irsim_version} · cases {content.results.cases or 'unknown'}"
        ),
        "sections": _sections(content),
        "arms": _options(arm.arm for arm in content.arms),
        "categories": _options(name for name, _ in content.categories),
        "note": "" if any(content.asked) else note(_CHANGED) + "\n",
        "cases": case_sections(content),
        "pictures": _pictures(content),
    }
    return one_page(_SOURCES, script, "img-src data:", **parts)


def _options(names: Iterable[str]) -> str:
    return "".join(f'<option value="{escaped(name)}">{escaped(name, 60)}</option>' for name in names)


def _pictures(content: Content) -> str:
    """Name → PNG file as base64; both are made of characters that need no escape."""
    pictures = content.gallery.pictures if content.gallery else {}
    return json.dumps({name: base64.b64encode(one.png).decode() for name, one in pictures.items()})


def _sections(content: Content) -> str:
    """All sections above the cases."""
    parts = {"Passed": _headline(content.arms)}
    for one in tables(content):
        parts[one.title] = _table(one.heads, one.rows) + (note(one.note) if one.note else "")
    sentences = [text for one in content.comparisons for text in one.sentences]
    if sentences:
        parts["One arm against the next"] = "".join(f"<p>{escaped(text, 600)}</p>" for text in sentences)
    if content.proof is not None:
        parts["Can the grader be believed?"] = _proof(content.proof)
    return "\n".join(f"<section><h2>{title}</h2>{body}</section>" for title, body in parts.items())


def _headline(arms: Sequence[ArmSummary]) -> str:
    strict, rate = "".join(_bar(arm, arm.strict) for arm in arms), "".join(_bar(arm, arm.rate) for arm in arms)
    several = any(arm.trials.total > arm.cases for arm in arms)
    return (
        f'<div class="bars"><div><h3>Every requirement of the case is met</h3>{strict}</div>'
        f"<div><h3>Requirements that are met</h3>{rate}</div></div>"
    ) + note(
        "Thin lines are Wilson's 95 % intervals with each case as one observation"
        + ("; several attempts at one case are averaged first." if several else ".")
    )


def _bar(arm: ArmSummary, interval: Interval) -> str:
    estimate, low, high = (0.0 if math.isnan(value) else value for value in interval)
    models = f' <span class="note">{escaped(", ".join(arm.models), 120)}</span>' if arm.models else ""
    words = (
        f"{percent(interval.estimate)} <span class='note'>{percent(low)} to {percent(high)}, {arm.cases} cases</span>"
    )
    return (
        f'<div class="bar"><span><b>{escaped(arm.arm, 60)}</b>{models}</span><span class="value">{words}</span>'
        '<svg viewBox="0 0 400 22" preserveAspectRatio="none" aria-hidden="true">'
        '<rect class="track" x="0" y="3" width="400" height="14" rx="3"/>'
        f'<rect class="fill" x="0" y="3" width="{400 * estimate:.1f}" height="14" rx="3"/>'
        f'<path class="whisker" d="M{400 * low:.1f} 6v8m0 -4H{400 * high:.1f}m0 -4v8" fill="none"/></svg></div>'
    )


def _proof(proof: Proof) -> str:
    totals = "".join(
        f"<li>{escaped(name)}: <b>{wrong}</b> ({share.estimate:.2%}; 95 % interval up to {share.high:.2%})</li>"
        for name, wrong, share in proof.totals()
    )
    rows = [[row.kind, row.operator, f"{row.trials:,}", str(row.wrong)] for row in proof.rows]
    items = "".join(f"<li>{_wrong(one)}</li>" for one in proof.wrong[:_MAX_WRONG])
    wrong = f"<h3>Graded wrongly</h3><ul>{items}</ul>" if items else ""
    table = part(f"All {len(rows)} operators", _table(["kind", "operator", "tried", "graded wrongly"], rows))
    left = sum(proof.left_out.values())
    rest = f"{left:,} mutants of facts that no prompt pins or leaves free were left out."
    return f"<ul>{totals}</ul>{wrong}{table}{note(rest) if left else ''}"


def _wrong(one: dict[str, object]) -> str:
    """One trial of the proof that was graded wrongly, in a line."""
    names = " ".join(str(one.get(key, "")) for key in ("case", "gold", "kind", "operator"))
    failed = one.get("failed")
    why = f"; does not hold: {', '.join(map(str, failed))}" if isinstance(failed, list) and failed else ""
    return escaped(f"{names}: {one.get('what', '')}{why}", 300)


def _table(heads: Sequence[str], rows: Sequence[Sequence[str | Cell]]) -> str:
    """A table: shares are darker where they are greater, texts that begin with a digit are aligned as numbers."""
    shares = [isinstance(cell, Cell) for cell in rows[0]] if rows else [False] * len(heads)
    top = "".join(
        f'<th scope="col"{" class=number" * share}>{escaped(head, 60)}</th>'
        for head, share in zip(heads, shares, strict=True)
    )
    body = "".join(
        f'<tr><th scope="row">{escaped(name)}</th>{"".join(map(_cell, cells))}</tr>' for name, *cells in rows
    )
    return f'<div class="wide" tabindex="0"><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'


def _cell(value: str | Cell) -> str:
    if isinstance(value, str):
        return f"<td{' class=number' * (value[:1].isdigit() or value == '–')}>{escaped(value)}</td>"
    if not value.total:
        return '<td class="share">–</td>'
    shade = math.ceil(value.share * 5)
    return f'<td class="share s{shade}">{value.passed} of {value.total} <small>{percent(value.share)}</small></td>'
