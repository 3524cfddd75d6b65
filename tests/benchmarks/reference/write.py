"""Keeps results of suites: ``python -m tests.benchmarks.reference.write NAME [FOLDER]`` for a name of ``TABLES``.

It runs the policies of the table that have no kept episodes, writes all of them (``NAME.csv.gz``), and makes the page
of them (``skills/irsim-benchmark/results/NAME.md``). Kept episodes are not run again, but the first ones are, as in
tests: if one is another, the table is not written, and ``--again`` runs all. With a folder, an interrupted run goes on.
"""

from __future__ import annotations

import argparse
import csv
import tempfile
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from irsim.benchmarks.plan import Plan
from irsim.benchmarks.report.markdown import markdown
from irsim.benchmarks.stored import prepare_plan, result_of_episodes, run_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.results.benchmark import EpisodeRow, SuiteResult
from tests.benchmarks.reference.kept import (
    FOLDER,
    Line,
    cells_of,
    columns_of,
    episode_of,
    is_kept,
    is_whole,
    kept_lines,
    source_of,
    write,
)
from tests.benchmarks.reference.roles import HEAD, page

__all__ = [
    "ONE_ROBOT",
    "PAGES",
    "TABLES",
    "Table",
    "changed_lines",
    "changes",
    "counted",
    "episodes_of",
    "kept_of",
    "main",
    "page_of",
    "result_of",
]

ONE_ROBOT = (
    "One robot drives, and its episode ends when it has arrived. Under yield, robots that have arrived make room, so "
    "every episode is equal to the one under freeze, and yield is not listed."
)
"""Note of pages whose scenarios have one robot each."""
PAGES = FOLDER.parents[2] / "skills" / "irsim-benchmark" / "results"


@dataclass(frozen=True)
class Table:
    """A kept result.

    Attributes:
        suite: Name of the suite.
        quick: Names of the scenarios that the quick tests run again.
        policies: The policies; None: the policies of the suite.
        again: Names of the scenarios that the slow tests run again; None: all.
        by_role: Whether ``roles.py`` makes the page.
        seeds: Number of seeds; None: the suite's.
        protocols: The protocols; None: the suite's. With ``freeze`` alone one robot drives.
    """

    suite: str
    quick: tuple[str, ...]
    policies: tuple[str, ...] | None = None
    again: tuple[str, ...] | None = None
    by_role: bool = False
    seeds: int | None = None
    protocols: tuple[Any, ...] | None = None

    def plan(self, **keys: Any) -> Plan:
        """Its plan, or a part of it."""
        whole = {"policies": self.policies, "seeds": self.seeds, "protocols": self.protocols}
        return suite_plan(self.suite, **(whole | keys)) if keys else _plan_of(self.suite, *whole.values())

    def lines(self, result: SuiteResult) -> list[dict[str, str]]:
        """One line per episode."""
        labels = {text: name for name, text in result.policies.items()}
        return [cells_of(episode, labels[episode.behavior], result.engine) for episode in result.episodes]


@cache
def _plan_of(suite: str, policies: Any, seeds: int | None, protocols: Any) -> Plan:
    return suite_plan(suite, policies=policies, seeds=seeds, protocols=protocols)


_ADDED = ("avocado", "footprint_orca", "rvo")
"""Policies that suites name and do not run by themselves."""
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
        ("robots-5", "robots-10", "robots-25", "step-10-0.05", "step-10-0.2"),
    ),
    "random_polygons_v2_networks": Table(
        "random_polygons_v2",
        ("robots-5",),
        (
            *("orca", "rvo", "dash", "avocado", "footprint_orca"),
            *("multi_robot_v2", "multi_robot", "multi_robot_freeze", "rl_rvo"),
        ),
        ("robots-5",),
        seeds=10,
    ),
    "random_polygons_v2_sarl": Table(
        "random_polygons_v2",
        ("robots-5",),
        ("orca", "footprint_orca", "multi_robot_v2", "rl_rvo", "sarl_multi_robot"),
        ("robots-5",),
        seeds=5,
    ),
    "circle_swap_v2": Table(
        "circle_swap_v2", ("diff-8",), ("orca", "rvo", "sfm", "dash", "avocado", "footprint_orca"), ("diff-8", "omni-8")
    ),
    "social_v2": Table(
        "social_v2",
        ("head-on",),
        ("as-written", "orca", "sfm", "dash", *_ADDED),
        again=("head-on", "doorway", "bottleneck"),
    ),
    "clutter_v2": Table(
        "clutter_v2",
        ("posts-15",),
        ("follow", "orca", "sfm", "dash", *_ADDED, "goal_lidar", "goal_lidar_noisy", "corridor_social"),
        again=("posts-15", "posts-45"),
        protocols=("freeze",),
    ),
    "crowdnav_circle_v2": Table(
        "crowdnav_circle_v2",
        ("circle-invisible-5",),
        ("orca", "orca-margin", "dash", *_ADDED),
        again=("circle-invisible-5", "circle-invisible-20"),
        protocols=("freeze",),
    ),
    "crowdnav_circle_v2_networks": Table(
        "crowdnav_circle_v2",
        ("circle-invisible-5",),
        ("orca", "orca-margin", "dash", "sarl", "crowd"),
        ("circle-invisible-5",),
        seeds=10,
        protocols=("freeze",),
    ),
    "maps_v2": Table("maps_v2", ("forest-1-0.15",), again=("maze",), seeds=10, protocols=("freeze",)),
}
"""Name -> table."""
_NOISY = {
    "random_polygons_v2": ("robots-5",),
    "circle_swap_v2": ("diff-8",),
    "social_v2": ("head-on",),
    "clutter_v2": ("posts-15",),
    "crowdnav_circle_v2": ("circle-invisible-5",),
}
"""Table whose suite has a twin under realism -> the scenarios of the twin that tests run again."""
TABLES |= {
    f"{name}_noisy": replace(TABLES[name], suite=f"{TABLES[name].suite}_noisy", quick=few, again=few, seeds=20)
    for name, few in _NOISY.items()
}


def kept_of(name: str) -> dict[tuple[str, str, int], dict[str, str]]:
    """Scenario, policy and seed → the kept line, of the episodes of a table that are in its file."""
    plan, lines = TABLES[name].plan(), kept_lines(name) if is_kept(name) else []
    every = {(line["scenario"], line["policy"], int(line["seed"])): line for line in lines}
    wanted = [(one.name, policy, seed) for one in plan.scenarios for policy in plan.policies for seed in plan.seeds]
    return {key: every[key] for key in wanted if key in every}


def episodes_of(name: str, columns: Sequence[str] | None = None) -> list[EpisodeRow]:
    """The episodes of a table, as its lines have them; None: with all columns."""
    policies, lines = TABLES[name].plan().policies, kept_of(name).values()
    chosen = [line if columns is None else {key: line[key] for key in columns} for line in lines]
    return [episode_of(line, policies[line["policy"]]) for line in chosen]


def result_of(name: str) -> SuiteResult:
    """The result of a table, from its kept lines alone."""
    result = result_of_episodes(TABLES[name].plan(), episodes_of(name))
    assert isinstance(result, SuiteResult)
    policies: dict[str, dict[str, None]] = {}
    for (_, policy, _), line in kept_of(name).items():
        policies.setdefault(line.get("engine", ""), {})[policy] = None
    engines = sorted(policies, key=lambda engine: not engine)
    if len(engines) > 1:
        engines = [f"{engine or 'an unknown one'} ({', '.join(policies[engine])})" for engine in engines]
    return result.model_copy(update={"engine": " and ".join(engines)})


def page_of(name: str) -> str:
    """The page of a table, from its kept lines alone."""
    if TABLES[name].by_role:
        return f"{page(kept_lines(name), TABLES[name].plan())}\n{source_of(name)}\n"
    counts = counted(kept_of(name).values())
    notes = [ONE_ROBOT] if TABLES[name].protocols == ("freeze",) else []
    return "\n".join([markdown(result_of(name), notes), *changes(name, counts), source_of(name), ""])


def changed_lines(name: str, made: Iterable[Line]) -> list[str]:
    """The episodes that are not the kept ones, in words.

    Args:
        name: Name of the table.
        made: Lines of episodes that were run now.
    """
    known = kept_of(name)
    changed = []
    for line in made:
        kept = known[line["scenario"], line["policy"], int(line["seed"])]
        odd = [
            f"{key} {line.get(key)}, kept {kept[key]}"
            for key in kept
            if key != "engine" and kept[key] != line.get(key, "")
        ]
        changed += [f"{line['scenario']}, {line['policy']}, seed {line['seed']}: {'; '.join(odd)}"] if odd else []
    return changed


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
    return ["## Before and now", "", about, "", "| scenario | policy | before | now |", "|---|---|---|---|", *rows, ""]


def _shares(counts: Sequence[int]) -> str:
    """Shares in %."""
    return " / ".join(f"{100 * count / sum(counts):.0f}" for count in counts)


def counted(lines: Iterable[Line]) -> dict[tuple[str, str], Counter[str]]:
    """(scenario, policy) → number of episodes by outcome."""
    outcomes: dict[tuple[str, str], Counter[str]] = {}
    for line in lines:
        outcomes.setdefault((line["scenario"], line["policy"]), Counter())[line["outcome"]] += 1
    return outcomes


def main(name: str, folder: str | None = None, *, again: bool = False) -> None:
    """Write a table: its episodes and its page.

    Args:
        name: Name of the table.
        folder: Folder in which a run that was interrupted goes on.
        again: Run every episode again.
    """
    table, known = TABLES[name], {}
    if not again:
        known = {key: line for key, line in kept_of(name).items() if table.by_role or is_whole(line)}
    plan = table.plan()
    names = {text: policy for policy, text in plan.policies.items()}
    wanted = [(scenario, names[text], task.seed) for scenario, text, task in prepare_plan(plan).plan]
    missing = list(dict.fromkeys(policy for scenario, policy, seed in wanted if (scenario, policy, seed) not in known))
    ready = [policy for policy in plan.policies if policy not in missing]
    if ready:
        with tempfile.TemporaryDirectory() as place:
            first = run_plan(table.plan(policies=ready, seeds=1, scenarios=table.quick), Path(place))
        assert isinstance(first, SuiteResult)
        if changed := changed_lines(name, table.lines(first)):
            raise SystemExit("\n".join(["the kept episodes differ from the ones that this program makes:", *changed]))
    if missing:
        with nullcontext(folder) if folder else tempfile.TemporaryDirectory() as place:
            result = run_plan(table.plan(policies=missing), Path(place), resume=folder is not None)
        assert isinstance(result, SuiteResult)
        known |= {(line["scenario"], line["policy"], int(line["seed"])): line for line in table.lines(result)}
    keep(name, [known[key] for key in wanted])


def keep(name: str, lines: Sequence[Line]) -> None:
    """Write the lines of a table, and its page."""
    write(name, HEAD if TABLES[name].by_role else columns_of(lines), lines)
    (PAGES / f"{name}.md").write_text(page_of(name), encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name", choices=TABLES)
    parser.add_argument("folder", nargs="?", help="go on with the episodes that are there")
    parser.add_argument("--again", action="store_true", help="run every episode again")
    given = parser.parse_args()
    main(given.name, given.folder, again=given.again)
