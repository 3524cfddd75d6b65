"""Everything that a report shows, computed once for the page, the Markdown file and the JSON file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from irsim_evals.cases.store import PUBLISHED, Instance, Store
from irsim_evals.report.comparison import Comparison, compare
from irsim_evals.report.failures import Category, category_of, counted
from irsim_evals.report.load import Proof, asked_of
from irsim_evals.report.pictures import Gallery, draw_trials
from irsim_evals.report.summary import ArmSummary, Table, arms_of, summarize, table_by
from irsim_evals.results import Results

__all__ = ["Content", "content_of"]


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
        title=title,
        results=results,
        asked=asked,
        arms=[summarize(trials, name) for name in names],
        categories=table_by(trials, names, lambda trial: trial.category),
        levels=table_by(trials, names, lambda trial: [f"level {trial.level}"]),
        comparisons=[one for one in pairs if one.pairs],
        failures={name: counted(category_of(t.verdict, t.ended) for t in own) for name, own in by_arm.items()},
        proof=proof,
        gallery=draw_trials(trials, asked, progress) if pictures else None,
    )
