"""The part of the page on a robot among recorded people: the suite ``pedestrians_v1``."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from irsim.benchmarks.plan import Plan
from irsim.benchmarks.stored import measure_plan
from irsim.benchmarks.suite_plan import suite_plan
from irsim.bridges.pedestrians.published import RECORDINGS, write_pedestrians_suite
from irsim.results.benchmark import BenchmarkRow, Estimate, Proportion, SuiteResult
from tests.benchmarks.pedestrians.human import FILES
from tests.benchmarks.reference.kept import cells_of, columns_of, write

POLICIES = ("orca", "{name: orca}", "sfm", "dash", "avocado", "footprint_orca")
"""``orca`` with the options of the suite, and policies with their defaults."""
_SPACE = "personal_space_intrusion_ratio"
KEPT = "pedestrians_v1"
"""Name of the kept file with the episodes, see :mod:`tests.benchmarks.reference.kept`."""


def plan_of(data: Path, policies: Sequence[str] | None = POLICIES, **chosen: object) -> Plan:
    """The plan of the suite over the files of a folder."""
    files = {name: data / file for name, file in zip(RECORDINGS, FILES.values(), strict=True)}
    with tempfile.TemporaryDirectory() as folder:
        made = write_pedestrians_suite(files, Path(folder) / "pedestrians_v1.yaml")
        return suite_plan(made.file, policies=policies, **chosen)  # type: ignore[arg-type]


def shown(policy: str) -> str:
    """A policy as the page names it."""
    return "orca of the suite" if policy == "orca" else policy


def lines_of(plan: Plan, result: SuiteResult) -> list[dict[str, str]]:
    """The kept lines of the episodes of the suite."""
    labels = {text: name for name, text in plan.policies.items()}
    return [cells_of(one, labels[one.behavior], result.engine) for one in result.episodes]


def measure(plan: Plan) -> SuiteResult:
    """Run the suite, or a part of it."""
    result = measure_plan(plan)
    assert isinstance(result, SuiteResult)
    return result


def keep(plan: Plan, result: SuiteResult) -> None:
    """Keep the episodes."""
    lines = lines_of(plan, result)
    write(KEPT, [*columns_of(lines), _SPACE], lines)


def parts(plan: Plan, result: SuiteResult) -> dict[str, str]:
    """The text of this part of the page."""
    lines = [
        "| recording | policy | n | success | collision | time-out | time [s] | nearest [m] | within 0.5 m |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for where in [*(f"(all {name})" for name in RECORDINGS), "(all)"]:
        rows = [row for row in result.rows if row.scenario == where]
        lines += [_line(where, policy, row) for policy, row in zip(POLICIES, rows, strict=True)]
    return {"hash": plan.suite_hash, "robots": "\n".join(lines)}


def _line(where: str, policy: str, row: BenchmarkRow) -> str:
    metrics = row.metrics
    cells = [
        where.strip("()").removeprefix("all ") if where != "(all)" else "all",
        f"`{shown(policy)}`",
        str(row.episodes),
        _share(row.success),
        _share(row.collision),
        _share(row.timeout),
        _mean(metrics["time_to_goal"], 1),
        _mean(metrics["distance_to_human_min"], 2),
        _mean(metrics[_SPACE], 2),
    ]
    return f"| {' | '.join(cells)} |"


def _share(share: Proportion) -> str:
    span = "" if share.low is None or share.high is None else f" [{100 * share.low:.0f}, {100 * share.high:.0f}]"
    return f"{100 * share.rate:.0f} %{span}"


def _mean(value: Estimate, digits: int) -> str:
    return "–" if value.mean is None else f"{value.mean:.{digits}f}"
