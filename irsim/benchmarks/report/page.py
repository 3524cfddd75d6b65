"""The report as one HTML page that needs nothing else."""

from __future__ import annotations

import base64
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape

from irsim.benchmarks.report.charts import charts
from irsim.benchmarks.report.markdown import (
    POLICIES,
    ROLES,
    Table,
    about_of,
    cells_of,
    citation_of,
    classes_of,
    columns_of,
    differences_of,
    facts_of,
    footnotes_of,
    program_of,
    ranks_of,
    roles_of,
    title_of,
    zones_of,
)
from irsim.benchmarks.report.rows import RANKS, policy_labels
from irsim.benchmarks.summary import is_summary
from irsim.common.hashing import digest
from irsim.common.text import clean, listed
from irsim.results.benchmark import BenchmarkResult
from irsim.runs.page_colors import scheme_rules

__all__ = ["Shown", "page"]


@dataclass(frozen=True)
class Shown:
    """An episode that is shown.

    Attributes:
        caption: Its caption.
        png: Picture of some moments.
        replay: Path of its replay, relative to the page; empty without one.
        again: Command that runs it again.
    """

    caption: str
    png: bytes
    replay: str = ""
    again: str = ""


def page(
    result: BenchmarkResult,
    shown: Sequence[Shown] = (),
    notes: Sequence[str] = (),
    again: Callable[[str, str, int], str] | None = None,
) -> str:
    """The page: facts, tables, charts, worst episodes, notes, and how to run it again.

    Rows over several scenarios come first in every table.

    Args:
        result: The result.
        shown: Episodes as pictures.
        notes: Further notes.
        again: The command that runs an episode again, of a scenario, a policy as text and a seed.
    """
    labels, columns = policy_labels(result), columns_of(result)
    title = _shown(title_of(result))
    rows = [[row.scenario, labels[row.behavior], str(row.episodes), *cells_of(row, columns)] for row in result.rows]
    main = (["scenario", "policy", "n", *(heading for _, heading in columns)], rows)
    zones, differences = zones_of(result), differences_of(result)
    failed = sum(len(seeds) for row in result.rows for seeds in row.failed.values())
    figures = [f"<figure>{svg}<figcaption>{_shown(caption)}</figcaption></figure>" for caption, svg in charts(result)]
    worst = [_episode(one) for one in shown]
    parts = [
        f"<h1>{title}</h1>", *(f"<p>{_prose(line)}</p>" for line in facts_of(result)),
        *(f"<p>{_prose(line)}</p>" for line in about_of(result)),
        _table(main), f'<p class="small">{_prose(" ".join(footnotes_of(result)))}</p>',
        "<h2>Zones</h2><p>Means over the robots.</p>" + _table(zones) if zones else "",
        f"<h2>{_shown(ROLES)}</h2>" + _table(roles) if (roles := roles_of(result)) else "",
        f"<h2>Differences to {_shown(labels[result.behaviors[0]])} with the same seeds</h2>" + _table(differences)
        if differences else "",
        f"<h2>{_shown(RANKS)}</h2>" + _table(ranks) if (ranks := ranks_of(result)) else "",
        f"<h2>{_shown(POLICIES)}</h2>",
        *(
            f"<p>{_prose(known or 'not stated')}</p><ul>"
            + "".join(f"<li>{_shown(labels[text])}: <code>{_shown(text)}</code></li>" for text in texts)
            + "</ul>"
            for known, texts in classes_of(result).items()
        ),
        *(f'<p class="note">{_prose(note)}</p>' for note in (*result.notes, *notes)),
        "<h2>Charts</h2>" if figures else "", f'<div class="charts">{"".join(figures)}</div>',
        f"<h2>Episodes that failed</h2><p>{len(worst)} of {failed:,} are shown.</p>" if worst else "", *worst,
        "<h3>All failed seeds</h3>" + _table(failures) if (failures := _failures(result, labels, again)) else "",
        "<h2>Run it again</h2>", f"<pre>{_shown(result.reproduce)}</pre><p>{_shown(program_of(result))}</p>",
        f"<h2>Cite this run</h2><p>{_prose(citation_of(result))}</p>",
    ]  # fmt: skip
    allowed = base64.b64encode(bytes.fromhex(digest(_SORT.encode()))).decode()
    body, colors = "\n".join(filter(None, parts)), scheme_rules(_COLORS)
    return _SHELL.format(title=title, body=body, script=_SORT, hash=allowed, colors=colors)


def _failures(
    result: BenchmarkResult, labels: Mapping[str, str], again: Callable[[str, str, int], str] | None
) -> Table | None:
    """Seeds that failed, by scenario, policy and outcome, and the command of the first one; None without any."""
    heads = ["scenario", "policy", "outcome", "failed", "seeds"] + ["the first one again"] * (again is not None)
    rows = []
    for row in result.rows:
        for outcome, seeds in row.failed.items():
            number, named = str(len(seeds)), listed([str(seed) for seed in seeds], MAX_SEEDS)
            command = [again(row.scenario, row.behavior, seeds[0])] if again else []
            rows.append([row.scenario, labels[row.behavior], outcome, number, named, *command])
    return (heads, rows) if rows else None


MAX_SEEDS = 20
"""Number of failed seeds of a row that are named."""
_COLORS = ("page", "card", "line", "ink", "muted", "near")
"""Colours of the style `modern` that the page uses."""
_WORDS = {
    "n": "episodes", "spl": "success by path (SPL)", "human [m]": "nearest person [m]",
    "discomfort": "time too close to people", "discomfort [m]": "distance when too close [m]",
    "between steps": "contacts between steps",
}  # fmt: skip
"""Heading of a table in a file -> its words on the page; others are words already, or keys of metrics."""


def _heading(text: str) -> str:
    return _WORDS.get(text, text.replace("_", " "))


def _shown(text: str) -> str:
    """A text of the result as HTML, without marks that change the direction of the text around it."""
    return escape(clean(text, 10**6))


def _prose(text: str) -> str:
    """A sentence of the result as HTML; words between backticks are code."""
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", _shown(text))


def _table(table: Table) -> str:
    """A table of scenarios and policies, which stay in sight; a scenario is named once where rows repeat it."""
    headings, rows = table
    lines, last = [], None
    for name, *cells in sorted(rows, key=lambda row: not is_summary(row[0])):
        mark = ' class="first"' if name != last else ""
        shown = [_shown(name if name != last else ""), *map(_unbroken, cells)]
        lines.append(f"<tr{mark}>" + "".join(f"<td>{cell}</td>" for cell in shown) + "</tr>")
        last = name
    head = "".join(
        f'<th scope="col" aria-sort="none"><button type="button">{_shown(_heading(text))}</button></th>'
        for text in headings
    )
    hint = '<p class="small hint" hidden>The table goes on to the right: scroll it sideways.</p>'
    return f'{hint}<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{"".join(lines)}</tbody></table></div>'


def _unbroken(cell: str) -> str:
    """A cell as HTML, whose interval stays in one line."""
    return re.sub(r"\([^()]* to [^()]*\)", r'<span class="whole">\g<0></span>', _shown(cell))


def _episode(one: Shown) -> str:
    picture = f'<img alt="{_shown(one.caption)}" src="data:image/png;base64,{base64.b64encode(one.png).decode()}">'
    link = f'<a href="{_shown(one.replay)}" title="{_shown(one.caption)}">{picture}</a>' if one.replay else picture
    told = f'<a href="{_shown(one.replay)}">{_shown(one.caption)}</a>' if one.replay else _shown(one.caption)
    again = f"<pre>{_shown(one.again)}</pre>" if one.again else ""
    return f'<figure class="episode">{link}<figcaption>{told}{again}</figcaption></figure>'


_SORT = """
for (const wide of document.querySelectorAll(".wide")) {
  const say = () => {
    const more = wide.scrollWidth > wide.clientWidth + 1;
    wide.previousElementSibling.hidden = !more;
    more ? wide.setAttribute("tabindex", "0") : wide.removeAttribute("tabindex");  // so that keys scroll it, too
  };
  const [first] = wide.firstChild.tHead.rows[0].cells;  // the policies stand still beside the scenarios
  const place = () => wide.style.setProperty("--first", first.offsetWidth + "px");
  for (const [act, seen] of [[say, wide], [place, first]]) { new ResizeObserver(act).observe(seen); act(); }
}
for (const table of document.querySelectorAll("table")) {
  const body = table.tBodies[0], heads = [...table.tHead.rows[0].cells];
  for (const row of body.rows)  // rows below a scenario get its name, so that they can move
    if (!row.cells[0].textContent) row.cells[0].textContent = row.previousElementSibling.cells[0].textContent;
  const written = [...body.rows], next = { none: "ascending", ascending: "descending", descending: "none" };
  heads.forEach((head, column) => head.firstChild.addEventListener("click", () => {
    const order = next[head.getAttribute("aria-sort")], sign = order === "descending" ? -1 : 1;
    for (const other of heads) other.setAttribute("aria-sort", "none");
    head.setAttribute("aria-sort", order);
    table.classList.toggle("sorted", order !== "none");
    if (order === "none") return body.append(...written);
    const value = row => row.cells[column].textContent, number = text => parseFloat(text.replace(/,/g, ""));
    const rows = [...written].sort((a, b) => {
      const [x, y] = [value(a), value(b)];
      if (!x || !y) return (!x) - (!y);  // empty cells stay at the end
      const [p, q] = [number(x), number(y)];
      return sign * (isNaN(p) || isNaN(q) ? x.localeCompare(y, "en", { numeric: true }) : p - q);
    });
    body.append(...rows);
  }));
}
"""
"""Says which tables scroll, and sorts a table by the column whose heading is clicked, or pressed with a key.

The second time sorts the other way, the third time restores the order of the report.
"""
_SHELL = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta http-equiv="Content-Security-Policy"
content="default-src 'none'; base-uri 'none'; form-action 'none'; img-src data:; style-src 'unsafe-inline';
script-src 'sha256-{hash}'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
:root {{ color-scheme: light dark; }}
{colors}
body {{ font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 76rem; padding: 0 1rem;
  background: var(--page); color: var(--ink); }}
a {{ color: var(--near); }}
.wide {{ overflow-x: auto; }}
table {{ border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 13px; }}
th, td, th button {{ padding: .2rem .7rem .2rem 0; text-align: left; vertical-align: baseline;
  white-space: nowrap; }}
th {{ border-bottom: 1px solid var(--ink); padding: 0; }}
:is(th, td):nth-child(-n+2) {{ position: sticky; left: 0; z-index: 1; background: var(--page); }}
:is(th, td):nth-child(2) {{ left: var(--first); }}
th button {{ width: 100%; font: inherit; font-weight: 600; color: inherit; background: none; border: 0;
  cursor: pointer; }}
th button:hover {{ color: var(--near); }}
th button:focus-visible {{ outline: 2px solid var(--near); outline-offset: -2px; }}
.whole {{ white-space: nowrap; }}
@media (max-width: 40rem) {{ :is(th, td):nth-child(-n+2) {{ max-width: 8rem; white-space: normal;
  overflow-wrap: break-word; font-size: 12px; }} :is(th, td):nth-child(2) {{ max-width: 5.5rem; }} }}
th[aria-sort=none] button::after {{ content: " \\2195"; color: var(--muted); font-weight: 400; }}
th[aria-sort=ascending] button::after {{ content: " \\2191"; }}
th[aria-sort=descending] button::after {{ content: " \\2193"; }}
tr.first td, .sorted td {{ border-top: 1px solid var(--line); }}
figure svg text {{ fill: currentColor; }}
figure svg g:has(> title) {{ cursor: help; }}
.hint {{ margin: 0 0 .2rem; }}
@page {{ size: landscape; }}
@media print {{ .hint {{ display: none; }} .wide {{ overflow: visible; }} table {{ font-size: 10px; }}
  :is(th, td):nth-child(n) {{ position: static; }} th, td, th button {{ white-space: normal; padding-right: .4rem; }}
  th[aria-sort=none] button::after {{ content: none; }} tr, .episode {{ break-inside: avoid; }} }}
@media screen and (prefers-color-scheme: dark) {{ figure img {{ filter: brightness(.8); border-radius: 6px; }} }}
.small, figcaption, .note {{ color: var(--muted); font-size: 13px; }}
.charts {{ display: grid; grid-template-columns: repeat(auto-fit, minmax(min(30rem, 100%), 1fr)); gap: 1rem; }}
figure {{ margin: 0 0 1rem; }}
figure svg, figure img {{ width: 100%; height: auto; }}
.episode {{ max-width: 60rem; }}
pre {{ overflow-x: auto; padding: .6rem; border: 1px solid var(--line); border-radius: 6px; }}
code {{ font-size: 13px; overflow-wrap: anywhere; }}
</style></head><body>
{body}
<script>{script}</script></body></html>
"""
