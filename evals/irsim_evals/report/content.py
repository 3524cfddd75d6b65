"""Everything that a report shows, computed once for the page, the Markdown file and the JSON file, and its tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from irsim_evals.cases.store import PUBLISHED, Instance, Store
from irsim_evals.report.comparison import Comparison, compare
from irsim_evals.report.failures import Category, category_of, counted, failure_rows
from irsim_evals.report.html_text import UNITS, number, percent
from irsim_evals.report.load import Proof, asked_of
from irsim_evals.report.pictures import Gallery, draw_trials
from irsim_evals.report.summary import ArmSummary, Cell, Table, arms_of, summarize, table_by
from irsim_evals.results import Results

__all__ = ["Content", "Section", "content_of", "tables"]

_STAGES = (
    "An answer leaves the funnel at the first stage in which a requirement does not hold: the file is parsed, fits "
    "the schema, loads, is sane (nothing overlaps, everything moves), and has the facts, the relations and the "
    "behavior that were asked for; then come edits of a given file and the reply."
)
_CHANCE = "The chance that all of k attempts at a case pass (pass^k), as a mean over the cases."
_COST = "The cost of all these answers, failed ones included, divided by the answers that pass."


@dataclass(frozen=True)
class Content:
    """The content of a report.

    Attributes:
        title: Title of the page.
        results: All trials.
        asked: Case of each trial as it was asked; None where it is not installed unchanged.
        arms: Numbers of each arm.
        categories, levels: Passes by category and by level.
        comparisons: Each arm compared with the one before.
        failures: Arm → category of failure → number of attempts.
        proof: Table of the proof of the grader, if it was given.
        gallery: Pictures; None if none are wanted.
    """

    title: str
    results: Results
    asked: Sequence[Instance | None]
    arms: list[ArmSummary]
    categories: Table
    levels: Table
    comparisons: list[Comparison]
    failures: dict[str, dict[Category, int]]
    proof: Proof | None = None
    gallery: Gallery | None = None


def content_of(
    results: Results,
    *,
    title: str = "irsim evals",
    proof: Proof | None = None,
    pictures: bool = True,
    progress: Callable[[int, int], None] | None = None,
    store: Store = PUBLISHED,
) -> Content:
    """Compute what a report shows about trials at the cases of ``store``; ``progress(done, total)`` is of pictures."""
    trials, names, asked = results.trials, arms_of(results.trials), asked_of(results, store)
    by_arm = {name: [trial for trial in trials if trial.arm == name] for name in names}
    pairs = [compare(by_arm[a], by_arm[b], a, b) for a, b in pairwise(names)]
    return Content(
        title=title, results=results, asked=asked, proof=proof, arms=[summarize(trials, name) for name in names],
        categories=table_by(trials, names, lambda trial: trial.category),
        levels=table_by(trials, names, lambda trial: [f"level {trial.level}"]),
        comparisons=[one for one in pairs if one.pairs],
        failures={name: counted(category_of(t.verdict, t.ended) for t in own) for name, own in by_arm.items()},
        gallery=draw_trials(trials, asked, progress) if pictures else None,
    )  # fmt: skip


@dataclass(frozen=True)
class Section:
    """A table with its title.

    Attributes:
        title: Title above the table.
        heads: Names of the columns.
        rows: Texts, which may hold anything, and shares.
        note: Sentence below the table.
    """

    title: str
    heads: list[str]
    rows: Sequence[Sequence[str | Cell]]
    note: str = ""


def tables(content: Content) -> list[Section]:
    """The tables that have something to show."""
    arms, names = content.arms, [arm.arm for arm in content.arms]
    funnel: list[list[str | Cell]] = [[stage, *(arm.funnel[stage] for arm in arms)] for stage in arms[0].funnel]
    tries = range(1, max(len(arm.pass_hat) for arm in arms) + 1)
    chances = [[arm.arm, *(percent(arm.pass_hat.get(k, math.nan)) for k in tries)] for arm in arms]
    sections = [
        Section("Where answers fail", ["no failure up to", *names], funnel, _STAGES),
        Section("Kinds of failures", ["main reason", *names, "which means"], failure_rows(content.failures)),
        Section("By category", ["category", *names], [[name, *cells] for name, cells in content.categories]),
        Section("By level", ["level", *names], [[name, *cells] for name, cells in content.levels],
                "1 is easy, 4 is hard."),
        Section("Several attempts", ["arm", *(f"k = {k}" for k in tries)], chances if len(tries) > 1 else [], _CHANCE),
        _costs(arms),
    ]  # fmt: skip
    return [section for section in sections if section.rows]


def _costs(arms: list[ArmSummary]) -> Section:
    """The costs of a pass for each arm; without rows if no cost is known."""
    names = list(dict.fromkeys(name for arm in arms for name in arm.cost.totals))
    heads = ["arm", "answers with a known cost", *(f"{UNITS.get(name, name)} per pass" for name in names)]
    rows = []
    for arm in arms if names else ():
        none = {name: "no pass" if name in arm.cost.totals else "–" for name in names}
        each = [none[name] if (cost := arm.cost.per_pass.get(name)) is None else number(cost) for name in names]
        rows.append([arm.arm, f"{arm.cost.known} of {arm.trials.total}", *each])
    return Section("Cost", heads, rows, _COST)
