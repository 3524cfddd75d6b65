"""Print how fast environments for learning step: ``python -m tests.speed.learning [TASK ...]``.

The ways to step are measured in turns, so that other work on the machine meets all of them.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from irsim.learning import VectorEnv
from tests.speed.scenes import SCENES

_HEAD = ("task", "slots", "threads", "workers", "slots per second", "times the first")
_OWN = {"name": "own", "features": ["vx", "yaw_rate"]}
_GOAL = {"name": "goal", "features": ["distance", "nearness", "cos", "sin"]}
_REWARD = [
    {"name": "progress"}, {"name": "arrival", "weight": 5}, {"name": "collision", "weight": -5}, {"name": "time"},
]  # fmt: skip
Document = dict[str, Any]


class Case(NamedTuple):
    """A task to be timed: a function that makes its name or its data, and the number of learners in all worlds."""

    task: Callable[[], str | Document]
    slots: int


def _lidar() -> Document:
    """One robot with 180 beams among polygons: the scene ``learner_lidar180``."""
    scenario = SCENES["learner_lidar180"].build()
    scenario["world"]["collision_mode"] = "stop"
    observation = [{"name": "scan", "nearness": True}, _GOAL, _OWN]
    return {
        "task": "lidar180", "scenario": scenario, "observation": observation, "reward": _REWARD, "horizon": 20,
    }  # fmt: skip


def _crowd(shape: Document) -> Document:
    """Ten robots that see eight neighbors each."""
    placed = {"name": "random", "range_low": [0.5, 0.5, -3.14], "range_high": [9.5, 9.5, 3.14], "min_distance": 1}
    robot = {"number": 10, "kinematics": {"name": "diff"}, "distribution": placed, "shape": shape}
    seen = ["x", "y", "vx", "vy", "radius", "gap", "nearness", "arrived", "robot"]
    return {
        "task": "crowd10",
        "scenario": {
            "world": {"width": 10, "height": 10, "step_time": 0.1, "collision_mode": "stop"},
            "robot": [robot | {"vel_max": [1, 3], "vel_min": [-1, -3], "goal_threshold": 0.3}],
        },
        "observation": [_OWN, _GOAL, {"name": "neighbors", "count": 8, "range": 4, "features": seen}],
        "reward": _REWARD,
        "ends": {"world": "all"},
        "horizon": 50,
    }


_POLYGON = {
    "name": "polygon", "random_shape": True, "is_convex": True, "avg_radius_range": [0.1, 0.5],
    "irregularity_range": [0, 0.6], "num_vertices_range": [4, 7],
}  # fmt: skip
CASES = {
    "lidar180": Case(_lidar, 1024),
    "goal_lidar": Case(lambda: "goal_lidar", 1024),
    "crowd10_circles": Case(lambda: _crowd({"name": "circle", "radius": 0.2}), 1000),
    "crowd10_polygons": Case(lambda: _crowd(_POLYGON), 1000),
    "multi_robot": Case(lambda: "multi_robot", 1400),
}


def rates(case: Case, ways: Sequence[tuple[int, int]], seconds: float, repeats: int = 5) -> list[float]:
    """Slots per second of each way to step, the best of the repeats.

    Actions are uniform draws; observations, rewards and resets of episodes that end are part of a step.

    Args:
        case: The task.
        ways: Numbers of threads and of workers.
        seconds: Time of each repeat [s].
        repeats: Number of turns.
    """
    envs = [
        VectorEnv(case.task(), case.slots, threads=t, workers=w, copy=False, autoreset_mode="SameStep") for t, w in ways
    ]
    low, high = envs[0].action_space.low, envs[0].action_space.high
    actions = np.random.default_rng(0).uniform(low, high, (16, *low.shape)).astype(np.float32)
    best = [0.0] * len(envs)
    for env in envs:
        env.reset(seed=1_000_000)
    for _ in range(repeats):
        for number, env in enumerate(envs):
            steps, began = 0, time.perf_counter()
            while time.perf_counter() - began < seconds:
                env.step(actions[steps % len(actions)])
                steps += 1
            best[number] = max(best[number], case.slots * steps / (time.perf_counter() - began))
    for env in envs:
        env.close()
    return best


def main(arguments: list[str] | None = None) -> int:
    """Print a table in Markdown, line by line as the tasks are measured."""
    parser = argparse.ArgumentParser(prog="python -m tests.speed.learning", description="Time steps of learning.")
    parser.add_argument("tasks", nargs="*", metavar="TASK", help=f"default: all of {', '.join(CASES)}")
    parser.add_argument(
        "--ways", nargs="*", default=["1/1", "2/1", "1/2"], metavar="THREADS/WORKERS", help="default: 1/1 2/1 1/2"
    )
    parser.add_argument("--seconds", type=float, default=1.0, help="time of each repeat (default: 1)")
    parser.add_argument("--repeats", type=int, default=5, help="number of turns, of which the best counts (default: 5)")
    given = parser.parse_args(arguments)
    unknown = [name for name in given.tasks if name not in CASES]
    if unknown:
        parser.error(f"unknown task {unknown[0]!r}; the tasks are {', '.join(CASES)}")
    ways = [(int(way.split("/")[0]), int(way.split("/")[1])) for way in given.ways]
    print(f"| {' | '.join(_HEAD)} |\n|{'---|' * len(_HEAD)}")
    for name in given.tasks or CASES:
        best = rates(CASES[name], ways, given.seconds, given.repeats)
        for (threads, workers), rate in zip(ways, best, strict=True):
            cells = name, f"{CASES[name].slots:,}", str(threads), str(workers), f"{rate:,.0f}", f"{rate / best[0]:.2f}"
            print(f"| {' | '.join(cells)} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
