"""Print how long policies take to decide: ``python -m tests.speed.decisions [POLICY ...]``."""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace

import numpy as np

from irsim.benchmarks.episode import Job, environment_of
from irsim.benchmarks.policies import job_keys
from irsim.benchmarks.suite_plan import suite_plan
from irsim.benchmarks.timing import time_behavior
from irsim.policies.behavior import BehaviorPolicy
from irsim.policies.driver import drivers_of

SUITE = "random_polygons_v1"
POLICIES = ("orca", "avocado", "ppo")
_HEAD = ("policy", "robots", "mean for one robot", "95th percentile", "mean for all")
_MAX_STEPS = 500


def times(policy: str, robots: int, seeds: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """(N, 2) wall-clock time of each decision [s] and the number of robots that it was for, one world at a time."""
    plan = suite_plan(SUITE, policies=[policy], scenarios=[f"robots-{robots}/yield"], seeds=seeds)
    [scenario], [opened] = plan.scenarios, plan.opened()
    document = scenario.document()
    job = Job(
        text=str(document.text), path=document.path, steps=None, strict=False, imports=(), limits=(), **job_keys(opened)
    )
    pairs: list[tuple[float, int]] = []
    for seed in plan.seeds:
        if isinstance(opened, BehaviorPolicy):
            pairs += time_behavior(job, seed)
            continue
        env = environment_of(replace(job, local=opened, policy=None), seed)
        env.simulation.advance(_MAX_STEPS, until_done=True)
        driver = next(iter(drivers_of(env.simulation)), None)
        assert driver is not None
        pairs += zip(driver.seconds, driver.decided, strict=True)
        env.end(ending_time=0.0)
    return np.array(pairs, dtype=np.float64).reshape(-1, 2)


def main(arguments: list[str] | None = None) -> int:
    """Print a table in Markdown, line by line as the policies are timed."""
    parser = argparse.ArgumentParser(prog="python -m tests.speed.decisions", description="Time decisions of policies.")
    parser.add_argument("policies", nargs="*", metavar="POLICY", help=f"default: {', '.join(POLICIES)}")
    parser.add_argument("--robots", type=int, nargs="*", default=[10, 25], help="numbers of robots (default: 10 25)")
    parser.add_argument("--seeds", type=int, default=5, help="number of episodes of each (default: 5)")
    given = parser.parse_args(arguments)
    print(f"| {' | '.join(_HEAD)} |\n|{'---|' * len(_HEAD)}")
    for name in given.policies or POLICIES:
        for robots in given.robots:
            timed = 1e3 * times(name, robots, given.seeds) * np.array([1.0, 1e-3])
            each = np.repeat(timed[:, 0] / timed[:, 1], timed[:, 1].astype(np.int64))
            values = each.mean(), np.percentile(each, 95), timed[:, 0].mean()
            print(f"| {name} | {robots} | {' | '.join(f'{value:.4g} ms' for value in values)} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
