"""The episodes of the tables: run again, or read from the files that are kept."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from irsim.benchmarks.plan import Plan
from irsim.benchmarks.stored import measure_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.results.benchmark import SuiteResult
from tests.benchmarks.authors_circle import outcomes
from tests.benchmarks.paper.tables import AUTHORS_SEEDS, POLICIES, Circle
from tests.benchmarks.reference.kept import kept_lines, write
from tests.benchmarks.reference.write import TABLES

__all__ = [
    "AUTHORS",
    "CIRCLE",
    "FULL",
    "authors",
    "circle",
    "full",
    "keep",
    "keep_circle",
    "keep_full",
    "kept",
    "kept_circle",
    "kept_full",
    "kept_table_2",
    "table_2",
]

SUITE = "random_polygons_v1"
AUTHORS, CIRCLE = (Path(__file__).with_name(name) for name in ("authors.csv", "circle.csv"))
FULL = "policies_of_the_paper"
"""Name of the kept file with the tables of 1,000 episodes, see :mod:`tests.benchmarks.reference.kept`."""
HEAD = (
    "scenario",
    "policy",
    "seed",
    "outcome",
    "steps",
    "time_to_goal",
    "velocity_avg",
    "path_length",
    "min_clearance",
)
FULL_HEAD = ("scenario", "policy", "seed", "outcome", "steps", "engine")
Report = Callable[[str], None]
Row = dict[str, str]


def _rows(plan: Plan, head: Sequence[str] = HEAD) -> list[Row]:
    """The episodes of a plan as lines of a kept file."""
    result = measure_plan(plan)
    assert isinstance(result, SuiteResult)
    return _columns(TABLES["table_2"].lines(result), head)


def _columns(lines: Sequence[Row], head: Sequence[str] = HEAD) -> list[Row]:
    return [{key: line[key] for key in head} for line in lines]


def table_2(report: Report, seeds: int | None = None) -> list[Row]:
    """The 7,000 episodes of the page, or the first seeds of each cell."""
    rows = list[Row]()
    for policy in POLICIES:
        rows += _rows(suite_plan(SUITE, policies=[policy], seeds=seeds))
        report(f"{policy}: {len(rows):,} episodes are done")
    return rows


def full(report: Report, seeds: Sequence[int] | None = None) -> list[Row]:
    """The 1,000 episodes of each cell with 5 and 10 robots, and of ``footprint_orca`` with all others.

    Args:
        report: Told how far it is.
        seeds: Some of the seeds; None: all.
    """
    rows = list[Row]()
    for policy in POLICIES:
        scenarios = None if policy == "footprint_orca" else ["robots-5", "robots-10"]
        plan = suite_plan(SUITE, policies=[policy], full=seeds is None, seeds=seeds, scenarios=scenarios)
        rows += _rows(plan, FULL_HEAD)
        report(f"{policy}: {len(rows):,} episodes are done")
    return rows


def authors(seeds: int | None = None) -> list[Row]:
    """The episodes of the authors' weights, which RL_RVO_WEIGHTS names."""
    chosen = list(AUTHORS_SEEDS)[:seeds]
    scenarios = ["robots-5", "robots-10"]
    return _rows(
        suite_plan(SUITE, policies=["rl_rvo_authors"], protocols=["freeze"], scenarios=scenarios, seeds=chosen)
    )


def circle(report: Report, seeds: int = 100) -> Iterator[Circle]:
    """The authors' circle, under their weights."""
    for robots in (6, 10, 14):
        for margin in (0.1, 0.2):
            for limited in (True, False):
                yield Circle(robots, margin, limited, outcomes(robots, range(seeds), free=not limited, margin=margin))
        report(f"the authors' circle with {robots} robots is done")


def kept_table_2() -> list[Row]:
    """The kept episodes of the page."""
    return _columns(kept_lines("table_2"))


def kept_full() -> list[Row]:
    """The kept episodes of the tables of 1,000 episodes."""
    return kept_lines(FULL)


def keep_full(rows: Sequence[Row]) -> None:
    """Write the episodes of the tables of 1,000 episodes."""
    write(FULL, FULL_HEAD, rows)


def kept(path: Path) -> list[Row]:
    """The rows of a kept file."""
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def keep(path: Path, rows: Sequence[Row]) -> None:
    """Write a kept file."""
    with path.open("w", encoding="utf-8", newline="") as file:
        written = csv.DictWriter(file, HEAD, lineterminator="\n")
        written.writeheader()
        written.writerows(rows)


def kept_circle() -> list[Circle]:
    """The kept outcomes of the authors' circle."""
    return [
        Circle(int(row["robots"]), float(row["margin"]), row["limited"] == "yes", row["outcomes"])
        for row in kept(CIRCLE)
    ]


def keep_circle(rows: Sequence[Circle]) -> None:
    """Write the outcomes of the authors' circle."""
    lines = [(*row[:2], "yes" if row.limited else "no", *row[3:]) for row in rows]
    with CIRCLE.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([Circle._fields, *lines])
