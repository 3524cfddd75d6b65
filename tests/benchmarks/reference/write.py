"""Keeps the result of a suite: ``python -m tests.benchmarks.reference.write SUITE`` (about 1 minute on 2 cores).

It writes the episodes (``SUITE.csv``) and the table with intervals (``skills/irsim-benchmark/results/SUITE.md``).
"""

from __future__ import annotations

import csv
import io
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from irsim.benchmarks.report.markdown import markdown
from irsim.benchmarks.stored import run_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.results.benchmark import EpisodeRow
from irsim.results.suite import SuiteResult

__all__ = ["FOLDER", "PAGES", "lines_of", "main"]

FOLDER = Path(__file__).parent
PAGES = FOLDER.parents[2] / "skills" / "irsim-benchmark" / "results"
_METRICS = ("time_to_goal", "velocity_avg", "path_length", "min_clearance")


def lines_of(episodes: Sequence[EpisodeRow], labels: dict[str, str]) -> list[str]:
    """One line per episode, numbers in full precision.

    Args:
        episodes: The episodes.
        labels: Behavior as text → name of the policy.
    """
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    for episode in episodes:
        values = [episode.metrics[key] for key in _METRICS]
        shown = ["" if value is None else repr(value) for value in values]
        rows.writerow(
            [episode.scenario, labels[episode.behavior], episode.seed, episode.outcome, episode.steps, *shown]
        )
    return text.getvalue().splitlines()


def main(suite: str) -> None:
    """Run a suite and keep its result."""
    with tempfile.TemporaryDirectory() as folder:
        result = run_plan(suite_plan(suite), Path(folder))
    assert isinstance(result, SuiteResult)
    labels = {text: name for name, text in result.policies.items()}
    head = ",".join(("scenario", "policy", "seed", "outcome", "steps", *_METRICS))
    lines = "\n".join([head, *lines_of(result.episodes, labels)])
    (FOLDER / f"{suite}.csv").write_text(lines + "\n", encoding="utf-8")
    (PAGES / f"{suite}.md").write_text(markdown(result), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
