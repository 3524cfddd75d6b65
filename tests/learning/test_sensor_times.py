"""Learners whose lidar measures at a rate, or whose scans arrive late: what they observe, batches and snapshots."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import irsim.learning.tasks as tasks
from irsim.learning import Env, Worlds
from tests.learning.tasks import EVERYTHING, NOISY, lidar_among_boxes
from tests.learning.test_snapshots import goes_on

ACTIONS = np.random.default_rng(3).uniform(-1, 1, (24, 3, 2))
GOAL_LIDAR = Path(tasks.__file__).parent / "bundled" / "goal_lidar.yaml"


def goal_lidar(**times: float) -> dict[str, Any]:
    """The published task with a lidar that takes its time, and scans with noise."""
    given: dict[str, Any] = yaml.safe_load(GOAL_LIDAR.read_text(encoding="utf-8"))
    [lidar] = given["scenario"]["robot"][0]["sensors"]
    lidar |= {"noise": True, "std": 0.05, **times}
    return given


def observed(given: dict[str, Any], threads: int = 1) -> np.ndarray:
    """(T + 1, 3, 36) scans of three learners that drive with the same actions."""
    worlds = Worlds(given, 3, seed=7, threads=threads)
    worlds.reset()
    seen = [worlds.observe().copy()]
    for step in ACTIONS:
        seen.append(worlds.advance(np.ascontiguousarray(step)).seen.copy())
    return np.array(seen)[..., :36]


@pytest.mark.parametrize("threads", [1, 2])
def test_a_learner_observes_the_scan_that_has_arrived(threads: int) -> None:
    """Steps of 0.1 s: after 0.25 s, which are three steps, it sees what the other one saw."""
    plain, late = observed(goal_lidar()), observed(goal_lidar(latency=0.25), threads)
    assert len(np.unique(plain[:, 0], axis=0)) == len(plain), "noise differs in each step"
    np.testing.assert_array_equal(late[3:], plain[:-3])
    assert (late[:3] == late[0]).all()
    assert not late[:3].any(), "without data there is nothing near"


def test_a_learner_observes_the_last_scan_between_two() -> None:
    plain, slow = observed(goal_lidar()), observed(goal_lidar(rate=2.5))
    np.testing.assert_array_equal(slow, plain[np.arange(len(plain)) // 4 * 4])


def timed(**keys: Any) -> dict[str, Any]:
    made = lidar_among_boxes(**keys)
    made["scenario"]["robot"][0] |= {"sensors": [{**NOISY, "rate": 4, "latency": 0.35}], "acce": [2, 4]}
    return made


@pytest.mark.parametrize("keys", [{}, {"randomize": EVERYTHING}], ids=["plain", "randomized"])
def test_an_environment_goes_on_with_scans_on_their_way(keys: dict[str, Any]) -> None:
    env = Env(timed(**keys))
    env.action_space.seed(0)
    goes_on(env, [env.action_space.sample() for _ in range(30)])


def test_learners_of_a_batch_observe_what_they_observe_alone() -> None:
    given = timed(randomize=EVERYTHING)
    together = Worlds(copy.deepcopy(given), 3, seed=5, threads=2)
    parts = [together.advance(np.ascontiguousarray(step)).seen.copy() for step in ACTIONS]
    again = Worlds(given, 3, seed=5)
    for step, expected in zip(ACTIONS, parts, strict=True):
        np.testing.assert_array_equal(again.advance(np.ascontiguousarray(step)).seen, expected)
