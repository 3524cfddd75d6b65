"""The page of a report: one HTML file that works without a network and asks for nothing but itself."""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

from irsim.common.pages import one_page
from irsim_evals.report.case_section import case_sections
from irsim_evals.report.content import Content
from irsim_evals.report.failures import failure_rows
from irsim_evals.report.html_text import UNITS, escaped, number, percent
from irsim_evals.report.load import Proof
from irsim_evals.report.summary import ArmSummary, Cell, Table
from irsim_evals.statistics import Interval

__all__ = ["page", "sections"]

_SOURCES = Path(__file__).with_name("web")
_CHANGED = (
    '<p class="note">These answers were graded with other cases than the installed ones. So changes of given '
    "files are not shown, and the second picture shows each world after 10 s.</p>\n"
)
_MAX_WRONG = 20
"""Number of wrong verdicts of the proof that are listed."""


def page(content: Content) -> str:
    """The page as text."""
    script = (_SOURCES / "report.js").read_text(encoding="utf-8")
    trials, count = content.results.trials, len(content.arms)
    parts = {
        "title": escaped(content.title, 120),
        "facts": escaped(
            f"{len({trial.key for trial in trials})} cases, {len(trials)} answers, "
            f"{count} {'arm' if count == 1 else 'arms'} · irsim {content.results.irsim_version} · "
            f"cases {content.results.cases or 'unknown'}"
        ),
        "sections": sections(content),
        "arms": _options(arm.arm for arm in content.arms),
        "categories": _options(name for name, _ in content.categories.rows),
        "note": "" if any(asked.known for asked in content.asked) else _CHANGED,
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


def sections(content: Content) -> str:
    """All sections above the cases."""
    parts = [
        _section("Passed", _headline(content.arms)),
        _section("Where answers fail", _funnel(content.arms)),
        *([_section("Kinds of failures", _kinds(content))] if any(content.failures.values()) else []),
        _section("By category", _table(content.categories, content.arms, "category")),
        _section("By level", _table(content.levels, content.arms, "level") + _note("1 is easy, 4 is hard.")),
    ]
    if any(len(arm.pass_hat) > 1 for arm in content.arms):
        parts.append(_section("Several attempts", _pass_hat(content.arms)))
    if any(arm.cost.known for arm in content.arms):
        parts.append(_section("Cost", _cost(content.arms)))
    if content.comparisons:
        parts.append(
            _section(
                "One arm against the next",
                "".join(f"<p>{escaped(text, 600)}</p>" for one in content.comparisons for text in one.sentences),
            )
        )
    if content.proof is not None:
        parts.append(_section("Can the grader be believed?", _proof(content.proof)))
    return "\n".join(parts)


def _section(title: str, body: str) -> str:
    return f"<section><h2>{title}</h2>{body}</section>"


def _note(text: str) -> str:
    return f'<p class="note">{text}</p>'


def _headline(arms: Sequence[ArmSummary]) -> str:
    groups = []
    for title, of in (("Every requirement of the case is met", 0), ("Requirements that are met", 1)):
        bars = "".join(_bar(arm, arm.rate if of else arm.strict) for arm in arms)
        groups.append(f"<div><h3>{title}</h3>{bars}</div>")
    several = any(arm.trials.total > arm.cases for arm in arms)
    note = "Thin lines are Wilson's 95 % intervals with each case as one observation" + (
        "; several attempts at one case are averaged first." if several else "."
    )
    return f'<div class="bars">{"".join(groups)}</div>{_note(note)}'


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


def _funnel(arms: Sequence[ArmSummary]) -> str:
    stages = list(arms[0].funnel) if arms else []
    rows = [[escaped(stage)] + [arm.funnel[stage] for arm in arms] for stage in stages]
    return _grid(["no failure up to", *(escaped(arm.arm, 60) for arm in arms)], rows) + _note(
        "An answer leaves the funnel at the first stage in which a requirement does not hold: the file is parsed, fits "
        "the schema, loads, is sane (nothing overlaps, everything moves), and has the facts, the relations and the "
        "behavior that were asked for; then come edits of a given file and the reply."
    )


def _kinds(content: Content) -> str:
    heads = ["main reason", *(escaped(arm, 60) for arm in content.failures), "which means"]
    return _plain(heads, failure_rows(content.failures))


def _table(table: Table, arms: Sequence[ArmSummary], name: str) -> str:
    rows: list[list[str | Cell]] = [[escaped(row), *cells] for row, cells in table.rows]
    return _grid([name, *(escaped(arm.arm, 60) for arm in arms)], rows)


def _pass_hat(arms: Sequence[ArmSummary]) -> str:
    most = max(len(arm.pass_hat) for arm in arms)
    rows = [
        [escaped(arm.arm, 60), *(percent(arm.pass_hat.get(k, math.nan)) for k in range(1, most + 1))] for arm in arms
    ]
    note = "The chance that all of k attempts at a case pass (pass^k), as a mean over the cases."
    return _plain(["arm", *(f"k = {k}" for k in range(1, most + 1))], rows) + _note(note)


def _cost(arms: Sequence[ArmSummary]) -> str:
    names = list(dict.fromkeys(name for arm in arms for name in arm.cost.totals))
    rows = []
    for arm in arms:
        cells = [escaped(arm.arm, 60), f"{arm.cost.known} of {arm.trials.total}"]
        for name in names:
            each = arm.cost.per_pass.get(name)
            none = "no pass" if name in arm.cost.totals else "–"
            cells.append(none if each is None else number(each))
        rows.append(cells)
    heads = ["arm", "answers with a known cost", *(f"{escaped(UNITS.get(n, n))} per pass" for n in names)]
    return _plain(heads, rows) + _note(
        "The cost of all these answers, failed ones included, divided by the answers that pass."
    )


def _proof(proof: Proof) -> str:
    totals = "".join(
        f"<li>{escaped(name)}: <b>{wrong}</b> ({share.estimate:.2%}; 95 % interval up to {share.high:.2%})</li>"
        for name, wrong, share in proof.totals()
    )
    rows = [
        [escaped(row.kind), escaped(row.operator), f"{row.trials:,}", str(row.wrong) if row.wrong else "0"]
        for row in proof.rows
    ]
    left = sum(proof.left_out.values())
    note = f"{left:,} mutants of facts that no prompt pins or leaves free were left out." if left else ""
    table = _plain(["kind", "operator", "tried", "graded wrongly"], rows)
    items = "".join(f"<li>{_wrong(one)}</li>" for one in proof.wrong[:_MAX_WRONG])
    wrong = f"<h3>Graded wrongly</h3><ul>{items}</ul>" if items else ""
    return (
        f'<ul>{totals}</ul>{wrong}<details class="part"><summary>All {len(rows)} operators</summary>{table}</details>'
        f"{_note(note) if note else ''}"
    )


def _wrong(one: dict[str, object]) -> str:
    """One trial of the proof that was graded wrongly, in a line."""
    names = " ".join(str(one.get(key, "")) for key in ("case", "gold", "kind", "operator"))
    failed = one.get("failed")
    why = f"; does not hold: {', '.join(map(str, failed))}" if isinstance(failed, list) and failed else ""
    return escaped(f"{names}: {one.get('what', '')}{why}", 300)


def _grid(heads: Sequence[str], rows: Iterable[Sequence[str | Cell]]) -> str:
    """A table of shares, darker where they are greater."""
    body = "".join(
        f'<tr><th scope="row">{row[0]}</th>{"".join(_share(c) for c in row[1:] if isinstance(c, Cell))}</tr>'
        for row in rows
    )
    top = f'<th scope="col">{heads[0]}</th>' + "".join(f'<th scope="col" class="number">{h}</th>' for h in heads[1:])
    return _wide(top, body)


def _share(cell: Cell) -> str:
    if not cell.total:
        return '<td class="share">–</td>'
    shade = math.ceil(cell.share * 5)
    return f'<td class="share s{shade}">{cell.passed} of {cell.total} <small>{percent(cell.share)}</small></td>'


def _plain(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of texts; those after the first that begin with a digit are aligned as numbers."""

    def cell(text: str, place: int) -> str:
        return (
            f'<td class="number">{text}</td>' if place and (text[:1].isdigit() or text == "–") else f"<td>{text}</td>"
        )

    body = "".join(f"<tr>{''.join(cell(text, k) for k, text in enumerate(row))}</tr>" for row in rows)
    return _wide("".join(f'<th scope="col">{head}</th>' for head in heads), body)


def _wide(top: str, body: str) -> str:
    return f'<div class="wide" tabindex="0"><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'
