"""``explored``: the share of the fog that the robots have seen, as a metric of benchmarks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import irsim
from irsim.benchmarks.episode import Job, Task, run_task
from irsim.benchmarks.together import run_together

# The lidar sees 2 m around; cells of 1 m. The robot drives 4 m along the middle of a corridor 8 m long.
FOG = """
world: {width: 8, height: 2, fog_map: true, fog_map_resolution: 1}
robot:
  - name: scout
    kinematics: {name: omni}
    shape: {name: circle, radius: 0.2}
    state: [1, 1, 0]
    goal: [5, 1]
    vel_max: [1, 1]
    behavior: {name: dash}
    sensors: [{name: lidar2d, range_max: 2, angle_range: 6.28318, number: 90}]
"""
POST = "obstacle: [{shape: {name: circle, radius: 0.2}, state: [3.4, 1]}]\n"


def explored_by_hand(env: irsim.Env, steps: int) -> float:
    for _ in range(steps):
        env.step()
    return float((np.array(env.simulation.state.explored[0]) > 0).mean())


def test_the_share_is_that_of_the_cells_at_the_end(make: Callable[..., irsim.Env]) -> None:
    [episode] = irsim.benchmark(FOG, seeds=1).episodes
    share = episode.metrics["explored"]
    assert (episode.outcome, share) == ("success", explored_by_hand(make(FOG, seed=0), episode.steps))
    assert share == irsim.run(text=FOG, seed=0).explored
    assert 0.6 < share < 1.0
    [clear] = irsim.benchmark(FOG.replace("fog_map: true, fog_map_resolution: 1", "time_limit: 9"), seeds=1).episodes
    assert clear.metrics["explored"] is None


def test_an_episode_that_ends_at_a_collision_has_explored_less(make: Callable[..., irsim.Env]) -> None:
    text = FOG.replace("fog_map: true", "fog_map: true, collision_mode: unobstructed") + POST
    [whole] = irsim.benchmark(text, seeds=1).episodes
    [cut] = irsim.benchmark(text, seeds=1, until="first_collision").episodes
    assert cut.steps < whole.steps
    assert cut.metrics["explored"] == explored_by_hand(make(text, seed=0), cut.steps) < whole.metrics["explored"]


@pytest.mark.parametrize("count", [1, 3])
def test_episodes_run_together_explore_what_single_ones_do(count: int) -> None:
    job = Job(text=FOG.replace("state: [1, 1, 0]", "distribution: {name: random}").replace("    goal: [5, 1]\n", ""),
              path=None, behavior="as-written", steps=80, strict=False, imports=(), limits=())  # fmt: skip
    seeds = list(range(count))
    together = [result["metrics"]["explored"] for result in run_together(job, seeds)]
    assert together == [run_task(Task(job, seed))["metrics"]["explored"] for seed in seeds]
