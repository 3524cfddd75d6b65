"""Writes episodes of a bundled suite, for the tests to repeat: ``python -m tests.benchmarks.crowdnav.write``."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path

from irsim.benchmarks.episode import Job, Task, run_task
from irsim.benchmarks.suite_plan import suite_plan

NAME = "crowdnav_circle_v1"
FILE = Path(__file__).with_name("episodes.csv")
POLICY = "orca"
SEEDS = 10
"""Number of seeds of each scenario, from the first one of the suite."""
METRICS = ("time_to_goal", "path_length", "distance_to_human_min", "discomfort_ratio", "crowdnav_reward")
HEADER = ("scenario", "seed", "outcome", "steps", *METRICS)


def rows(seeds: int = SEEDS, scenarios: Sequence[str] | None = None) -> list[str]:
    """The lines of the first seeds of each scenario, without the header. Numbers have 9 digits."""
    plan = suite_plan(NAME, policies=[POLICY], scenarios=scenarios)
    lines = []
    for one in plan.scenarios:
        job = Job(one.text, None, plan.policies[POLICY], None, True, (), (), plan.until)
        for seed in plan.seeds[:seeds]:
            result = run_task(Task(job, seed))
            values = [result["metrics"][key] for key in METRICS]
            text = ["" if math.isnan(value) else f"{value:.9g}" for value in values]
            lines.append(_line([one.name, str(seed), result["outcome"], str(result["steps"]), *text]))
    return lines


def _line(cells: Sequence[str]) -> str:
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="").writerow(cells)
    return buffer.getvalue()


if __name__ == "__main__":
    FILE.write_text("\n".join([_line(HEADER), *rows()]) + "\n", encoding="utf-8")
    print(f"wrote {FILE}")
