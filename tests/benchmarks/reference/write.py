"""Keeps results of suites: ``python -m tests.benchmarks.reference.write NAME`` for a name of ``TABLES``.

It writes the episodes (``NAME.csv``) and the table with intervals (``skills/irsim-benchmark/results/NAME.md``).
"""

from __future__ import annotations

import csv
import io
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from irsim.benchmarks.plan import Plan
from irsim.benchmarks.report.markdown import markdown
from irsim.benchmarks.stored import run_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.results.benchmark import EpisodeRow
from irsim.results.suite import SuiteResult

__all__ = ["FOLDER", "PAGES", "TABLES", "Table", "lines_of", "main"]

FOLDER = Path(__file__).parent
PAGES = FOLDER.parents[2] / "skills" / "irsim-benchmark" / "results"


@dataclass(frozen=True)
class Table:
    """A kept result.

    Attributes:
        suite: Name of the suite.
        policies: The policies; None: those that the suite runs.
        again: Names of the scenarios that the tests run again; None: all.
    """

    suite: str
    policies: tuple[str, ...] | None = None
    again: tuple[str, ...] | None = None

    def plan(self, **keys: Any) -> Plan:
        """Its plan, or a part of it."""
        return suite_plan(self.suite, policies=self.policies, **keys)


TABLES = {
    "random_polygons_v1": Table("random_polygons_v1"),
    "table_2": Table(
        "random_polygons_v1",
        ("orca", "avocado", "sarl_multi_robot", "rl_rvo", "ppo", "ppo_freeze", "footprint_orca"),
        ("robots-5", "robots-10"),
    ),
}
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


def main(name: str) -> None:
    """Run a suite and keep its result."""
    with tempfile.TemporaryDirectory() as folder:
        result = run_plan(TABLES[name].plan(), Path(folder))
    assert isinstance(result, SuiteResult)
    labels = {text: name for name, text in result.policies.items()}
    head = ",".join(("scenario", "policy", "seed", "outcome", "steps", *_METRICS))
    lines = "\n".join([head, *lines_of(result.episodes, labels)])
    (FOLDER / f"{name}.csv").write_text(lines + "\n", encoding="utf-8")
    (PAGES / f"{name}.md").write_text(markdown(result), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
