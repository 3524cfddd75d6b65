"""Print how fast environments for learning step: ``python -m tests.speed.learning [TASK ...]``."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np

from irsim.learning import VectorEnv
from tests.speed.scenes import SCENES

_HEAD = ("task", "slots", "threads", "slots per second", "per second of processor time")
_OWN = {"name": "own", "features": ["vx", "yaw_rate"]}
_GOAL = {"name": "goal", "features": ["distance", "nearness", "cos", "sin"]}
_REWARD = [
    {"name": "progress"},
    {"name": "arrival", "weight": 5},
    {"name": "collision", "weight": -5},
    {"name": "time"},
]
Document = dict[str, Any]


@dataclass(frozen=True)
class Case:
    """A task to be timed.

    Attributes:
        task: Makes the task: its name, or its data.
        slots: Number of learners in all worlds.
    """

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


def rates(case: Case, threads: int, workers: int, seconds: float, repeats: int = 5) -> tuple[float, float]:
    """Slots per second of wall time and of processor time, each the median of the repeats.

    Actions are uniform draws; observations, rewards and resets of episodes that end are part of a step.
    """
    env = VectorEnv(case.task(), case.slots, threads=threads, workers=workers, copy=False, autoreset_mode="SameStep")
    env.reset(seed=1_000_000)
    low, high = env.action_space.low, env.action_space.high
    actions = np.random.default_rng(0).uniform(low, high, (16, *low.shape)).astype(np.float32)
    wall, processor = [], []
    for _ in range(repeats):
        steps, began, used = 0, time.perf_counter(), time.process_time()
        while time.perf_counter() - began < seconds:
            env.step(actions[steps % len(actions)])
            steps += 1
        wall.append(case.slots * steps / (time.perf_counter() - began))
        processor.append(case.slots * steps / (time.process_time() - used))
    env.close()
    return median(wall), median(processor)


def main(arguments: list[str] | None = None) -> int:
    """Print a table in Markdown, line by line as the tasks are measured."""
    parser = argparse.ArgumentParser(prog="python -m tests.speed.learning", description="Time steps of learning.")
    parser.add_argument("tasks", nargs="*", metavar="TASK", help=f"default: all of {', '.join(CASES)}")
    parser.add_argument("--threads", type=int, nargs="*", default=[1, 2], help="numbers of threads (default: 1 2)")
    parser.add_argument("--seconds", type=float, default=1.0, help="time of each of 5 repeats (default: 1)")
    given = parser.parse_args(arguments)
    unknown = [name for name in given.tasks if name not in CASES]
    if unknown:
        parser.error(f"unknown task {unknown[0]!r}; the tasks are {', '.join(CASES)}")
    print(f"| {' | '.join(_HEAD)} |\n|{'---|' * len(_HEAD)}")
    for name in given.tasks or CASES:
        for threads in given.threads:
            wall, processor = rates(CASES[name], threads, given.seconds)
            cells = name, f"{CASES[name].slots:,}", str(threads), f"{wall:,.0f}", f"{processor:,.0f}"
            print(f"| {' | '.join(cells)} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
