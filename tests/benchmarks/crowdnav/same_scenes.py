"""irsim in the scenes of CrowdNav: ``python -m tests.benchmarks.crowdnav.same_scenes``.

``with_rvo2.py`` draws the scenes, not the suite. The output has the shares, and the number of episodes with the same
outcome and time as RVO2 has when contacts are looked for at the ends of steps (``rvo2.csv``).
"""

from __future__ import annotations

import csv
from collections.abc import Sequence

import yaml

from irsim.benchmarks.episode import Job, Task, run_task
from irsim.benchmarks.suite_plan import suite_plan
from tests.benchmarks.crowdnav.with_rvo2 import EPISODES, FIRST_SEED, FOLDER, PUBLISHED, scene, summary
from tests.benchmarks.crowdnav.write import NAME, POLICY

__all__ = ["episodes", "kept", "main"]


def episodes(seeds: Sequence[int]) -> list[tuple[str, float]]:
    """Outcome and time [s] of the published scenario in the scenes of CrowdNav with these seeds."""
    plan = suite_plan(NAME, policies=[POLICY], scenarios=[PUBLISHED])
    data = yaml.safe_load(plan.scenarios[0].text)
    (people,) = data["obstacle"]
    results = []
    for seed in seeds:
        _, *discs = scene(seed, people["number"])
        places = {"state": [[*one.place, 0.0] for one in discs], "goal": [list(one.goal) for one in discs]}
        data["obstacle"] = [people | {"distribution": {"name": "manual"}} | places]
        job = Job(yaml.safe_dump(data), None, plan.policies[POLICY], None, True, (), (), plan.until)
        result = run_task(Task(job, seed))
        results.append((result["outcome"], result["sim_time"]))
    return results


def kept() -> dict[int, tuple[str, float]]:
    """Seed -> outcome and time [s] of RVO2, with contacts looked for at the ends of steps."""
    with (FOLDER / "rvo2.csv").open(encoding="utf-8") as file:
        return {int(row["seed"]): (row["outcome_ends"], float(row["time_ends"])) for row in csv.DictReader(file)}


def main() -> None:
    """Print the row of the page, and the comparison."""
    seeds = range(FIRST_SEED, FIRST_SEED + EPISODES)
    ours, theirs = episodes(seeds), [kept()[seed] for seed in seeds]
    success, collision, timeout, time = summary(ours)
    print(f"| {success:.3f} | {collision:.3f} | {timeout:.3f} | {time:.2f} s |")
    pairs = list(zip(ours, theirs, strict=True))
    same = sum(mine[0] == other[0] for mine, other in pairs)
    won = [mine == other for mine, other in pairs if mine[0] == other[0] == "success"]
    times = f"same time in {sum(won)} of the {len(won)} that succeed"
    print(f"same outcome as RVO2 in {same} of {len(pairs)} episodes, {times}")


if __name__ == "__main__":
    main()
