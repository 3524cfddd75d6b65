"""The report as one HTML page that needs nothing else."""

from __future__ import annotations

import base64
from collections.abc import Sequence
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
from irsim.common.text import clean
from irsim.results.benchmark import BenchmarkResult

__all__ = ["Shown", "page"]


@dataclass(frozen=True)
class Shown:
    """An episode that is shown.

    Attributes:
        caption: Its caption.
        png: Picture of some moments.
        replay: Path of its replay, relative to the page; empty without one.
    """

    caption: str
    png: bytes
    replay: str = ""


def page(result: BenchmarkResult, shown: Sequence[Shown] = (), notes: Sequence[str] = ()) -> str:
    """The page: facts, tables, charts, worst episodes, notes, and how to run it again."""
    labels, columns = policy_labels(result), columns_of(result)
    title = _shown(title_of(result))
    rows = [[row.scenario, labels[row.behavior], str(row.episodes), *cells_of(row, columns)] for row in result.rows]
    main = (["scenario", "policy", "n", *(heading for _, heading in columns)], rows)
    zones, differences = zones_of(result), differences_of(result)
    failed = sum(one.outcome in ("collision", "timeout") for one in result.episodes)
    figures = [f"<figure>{svg}<figcaption>{_shown(caption)}</figcaption></figure>" for caption, svg in charts(result)]
    worst = [_episode(one) for one in shown]
    parts = [
        f"<h1>{title}</h1>", *(f"<p>{_shown(line)}</p>" for line in facts_of(result)),
        *(f"<p>{_shown(line)}</p>" for line in about_of(result)),
        _table(main), f'<p class="small">{_shown(" ".join(footnotes_of(result)))}</p>',
        "<h2>Zones</h2><p>Means over the robots.</p>" + _table(zones) if zones else "",
        f"<h2>{_shown(ROLES)}</h2>" + _table(roles) if (roles := roles_of(result)) else "",
        f"<h2>Differences to {_shown(labels[result.behaviors[0]])} with the same seeds</h2>" + _table(differences)
        if differences else "",
        f"<h2>{_shown(RANKS)}</h2>" + _table(ranks) if (ranks := ranks_of(result)) else "",
        f"<h2>{_shown(POLICIES)}</h2>",
        *(
            f"<p>{_shown(known or 'not stated')}</p><ul>"
            + "".join(f"<li>{_shown(labels[text])}: <code>{_shown(text)}</code></li>" for text in texts)
            + "</ul>"
            for known, texts in classes_of(result).items()
        ),
        *(f'<p class="note">{_shown(note)}</p>' for note in (*result.notes, *notes)),
        "<h2>Charts</h2>" if figures else "", f'<div class="charts">{"".join(figures)}</div>',
        f"<h2>Episodes that failed</h2><p>{len(worst)} of {failed:,} are shown.</p>" if worst else "", *worst,
        "<h2>Run it again</h2>", f"<pre>{_shown(result.reproduce)}</pre><p>{_shown(program_of(result))}</p>",
        f"<h2>Cite this run</h2><p>{_shown(citation_of(result))}</p>",
    ]  # fmt: skip
    return _SHELL.format(title=title, body="\n".join(filter(None, parts)))


def _shown(text: str) -> str:
    """A text of the result as HTML, without marks that change the direction of the text around it."""
    return escape(clean(text, 10**6))


def _table(table: Table) -> str:
    """A table whose first column is empty where it repeats the row above."""
    headings, rows = table
    lines, last = [], None
    for name, *cells in rows:
        mark = ' class="first"' if name != last else ""
        shown = [name if name != last else "", *cells]
        lines.append(f"<tr{mark}>" + "".join(f"<td>{_shown(cell)}</td>" for cell in shown) + "</tr>")
        last = name
    head = "".join(f"<th>{_shown(text)}</th>" for text in headings)
    return f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{"".join(lines)}</tbody></table></div>'


def _episode(one: Shown) -> str:
    picture = f'<img alt="{_shown(one.caption)}" src="data:image/png;base64,{base64.b64encode(one.png).decode()}">'
    link = f'<a href="{_shown(one.replay)}">{picture}</a>' if one.replay else picture
    more = f' <a href="{_shown(one.replay)}">replay</a>' if one.replay else ""
    return f'<figure class="episode">{link}<figcaption>{_shown(one.caption)}{more}</figcaption></figure>'


_SHELL = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta http-equiv="Content-Security-Policy"
content="default-src 'none'; base-uri 'none'; form-action 'none'; img-src data:; style-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
:root {{ color-scheme: light dark; --line: #ccc; --soft: #666; --back: #fff; --text: #111; }}
@media (prefers-color-scheme: dark) {{ :root {{ --line: #444; --soft: #aaa; --back: #16181c; --text: #eee; }}
  figure svg {{ background: #fff; border-radius: 6px; }} }}
body {{ font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 76rem; padding: 0 1rem;
  background: var(--back); color: var(--text); }}
.wide {{ overflow-x: auto; }}
table {{ border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 13px; }}
th, td {{ padding: .2rem .7rem .2rem 0; text-align: left; white-space: nowrap; }}
th {{ border-bottom: 1px solid var(--text); }}
tr.first td {{ border-top: 1px solid var(--line); }}
.small, figcaption, .note {{ color: var(--soft); font-size: 13px; }}
.charts {{ display: grid; grid-template-columns: repeat(auto-fit, minmax(min(30rem, 100%), 1fr)); gap: 1rem; }}
figure {{ margin: 0 0 1rem; }}
figure svg, figure img {{ width: 100%; height: auto; }}
.episode {{ max-width: 60rem; }}
pre {{ overflow-x: auto; padding: .6rem; border: 1px solid var(--line); border-radius: 6px; }}
code {{ font-size: 13px; overflow-wrap: anywhere; }}
</style></head><body>
{body}
</body></html>
"""
