"""Keeps results of suites: ``python -m tests.benchmarks.reference.write NAME [FOLDER]`` for a name of ``TABLES``.

It writes the episodes (``NAME.csv``) and the table with intervals (``skills/irsim-benchmark/results/NAME.md``). Pages
of suites v1 also have the shares that were others before contacts between steps were counted and limits planned with
(``before/``).
"""

from __future__ import annotations

import csv
import hashlib
import io
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from irsim.benchmarks.plan import Plan
from irsim.benchmarks.report.markdown import markdown
from irsim.benchmarks.stored import run_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.results.benchmark import EpisodeRow, SuiteResult
from tests.benchmarks.reference.roles import HEAD, page, values_by_role

__all__ = ["FOLDER", "PAGES", "TABLES", "Table", "changes", "counted", "kept", "lines_of", "main"]

FOLDER = Path(__file__).parent
PAGES = FOLDER.parents[2] / "skills" / "irsim-benchmark" / "results"


@dataclass(frozen=True)
class Table:
    """A kept result.

    Attributes:
        suite: Name of the suite.
        policies: The policies; None: the policies of the suite.
        quick: Names of the scenarios that the quick tests run again.
        again: Names of the scenarios that the slow tests run again; None: all.
        by_role: Whether ``roles.py`` writes lines and page.
    """

    suite: str
    quick: tuple[str, ...]
    policies: tuple[str, ...] | None = None
    again: tuple[str, ...] | None = None
    by_role: bool = False

    def plan(self, **keys: Any) -> Plan:
        """Its plan, or a part of it."""
        return suite_plan(self.suite, policies=self.policies, **keys)

    def lines(self, result: SuiteResult) -> list[str]:
        """One line per episode."""
        labels = {text: name for name, text in result.policies.items()}
        return lines_of(result.episodes, labels, values_by_role if self.by_role else _values)


TABLES = {
    "random_polygons_v1": Table("random_polygons_v1", ("robots-5", "robots-10")),
    "table_2": Table(
        "random_polygons_v1",
        ("robots-5",),
        ("orca", "avocado", "sarl_multi_robot", "rl_rvo", "ppo", "ppo_freeze", "footprint_orca"),
        ("robots-5", "robots-10"),
    ),
    "mixed_v2": Table("mixed_v2", ("one-people", "half-orca"), again=("one-rl_rvo", "half-people"), by_role=True),
    "random_polygons_v2": Table(
        "random_polygons_v2",
        ("robots-5", "step-10-0.2"),
        ("orca", "rvo", "dash", "avocado", "footprint_orca"),
        ("robots-5", "robots-10", "step-10-0.05", "step-10-0.2"),
    ),
    "circle_swap_v2": Table(
        "circle_swap_v2", ("diff-8",), ("orca", "rvo", "sfm", "dash", "avocado", "footprint_orca"), ("diff-8", "omni-8")
    ),
    "social_v2": Table("social_v2", ("head-on",), again=("head-on", "doorway")),
    "clutter_v2": Table("clutter_v2", ("posts-15",), again=("posts-15",)),
    "crowdnav_circle_v2": Table("crowdnav_circle_v2", ("circle-invisible-5",), again=("circle-invisible-5",)),
}
_METRICS = ("time_to_goal", "velocity_avg", "path_length", "min_clearance")


def lines_of(
    episodes: Sequence[EpisodeRow], labels: Mapping[str, str], values_of: Callable[[EpisodeRow], list[float | None]]
) -> list[str]:
    """One line per episode, numbers in full precision.

    Args:
        episodes: The episodes.
        labels: Behavior as text → name of the policy.
        values_of: The metrics of an episode.
    """
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    for episode in episodes:
        shown = ["" if value is None else repr(value) for value in values_of(episode)]
        rows.writerow(
            [episode.scenario, labels[episode.behavior], episode.seed, episode.outcome, episode.steps, *shown]
        )
    return text.getvalue().splitlines()


def _values(episode: EpisodeRow) -> list[float | None]:
    return [episode.metrics[key] for key in _METRICS]


def changes(name: str, outcomes: Mapping[tuple[str, str], Counter[str]]) -> list[str]:
    """The lines of a table with the shares that have changed, old and new side by side; none where no old ones are.

    Args:
        name: Name of the table.
        outcomes: (scenario, policy) → number of episodes by outcome, now.
    """
    kinds, rows, same = ("success", "collision", "timeout"), list[str](), dict[str, bool]()
    if not (FOLDER / "before" / f"{name}.csv").exists():
        return []
    with (FOLDER / "before" / f"{name}.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            scenario, policy = row["scenario"], row["policy"]
            old, new = [int(row[kind]) for kind in kinds], [outcomes[scenario, policy][kind] for kind in kinds]
            same[policy] = same.get(policy, True) and old == new
            if old != new:
                rows.append(f"| {scenario} | {policy} | {_shares(old)} | {_shares(new)} |")
    equal = " and ".join(f"`{policy}`" for policy, is_same in same.items() if is_same)
    about = (
        "Robots now plan with their limits and with the step, walls are walls however they are written, and ties are "
        "broken. Contacts between steps, which were not counted before, are counted and still not judged here. Success "
        f"/ collision / timeout in %, where they differ; all shares of {equal} are the same."
    )
    return ["## Before and now", "", about, "", "| scenario | policy | before | now |", "|---|---|---|---|", *rows]


def kept(name: str) -> str:
    """The line of a page that says where its episodes are."""
    path = FOLDER / f"{name}.csv"
    where = f"`{path.relative_to(FOLDER.parents[2]).as_posix()}` of the repository"
    return f"\nAll episodes: {where}, SHA-256 `{hashlib.sha256(path.read_bytes()).hexdigest()}`."


def _shares(counts: Sequence[int]) -> str:
    """Shares in %."""
    return " / ".join(f"{100 * count / sum(counts):.0f}" for count in counts)


def counted(episodes: Iterable[Mapping[str, str]]) -> dict[tuple[str, str], Counter[str]]:
    """(scenario, policy) → number of episodes by outcome, of lines of a kept file."""
    outcomes: dict[tuple[str, str], Counter[str]] = {}
    for row in episodes:
        outcomes.setdefault((row["scenario"], row["policy"]), Counter())[row["outcome"]] += 1
    return outcomes


def main(name: str, folder: str | None = None) -> None:
    """Run a suite and keep its result; with a folder, go on with the episodes that are there."""
    with nullcontext(folder) if folder else tempfile.TemporaryDirectory() as place:
        result = run_plan(TABLES[name].plan(), Path(place), resume=folder is not None)
    assert isinstance(result, SuiteResult)
    head = HEAD if TABLES[name].by_role else ("scenario", "policy", "seed", "outcome", "steps", *_METRICS)
    episodes = [",".join(head), *TABLES[name].lines(result)]
    (FOLDER / f"{name}.csv").write_text("\n".join(episodes) + "\n", encoding="utf-8")
    if TABLES[name].by_role:
        text = page(list(csv.DictReader(episodes)), TABLES[name].plan()) + f"{kept(name)}\n"
    else:
        text = "\n".join([markdown(result), *changes(name, counted(csv.DictReader(episodes))), kept(name), ""])
    (PAGES / f"{name}.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
