"""The parallel environment of PettingZoo."""

from __future__ import annotations

import numpy as np
from pettingzoo.test import parallel_api_test, parallel_seed_test

from irsim.learning import ParallelEnv
from tests.learning.tasks import crowd, task


def test_the_tests_of_pettingzoo_pass() -> None:
    parallel_api_test(ParallelEnv(crowd(protocol="freeze")), num_cycles=300)
    parallel_seed_test(lambda: ParallelEnv(crowd()), num_cycles=50)


def test_robots_that_have_arrived_leave() -> None:
    names = {"name": "ann", "state": [8.65, 5, 0]}, {"name": "bob", "state": [8.45, 2, 0], "goal": [9, 2]}
    env = ParallelEnv(task(*names, protocol="freeze", reward=[{"name": "arrival"}]))
    env.reset(seed=0)
    ahead = np.array([1.0, 0.0])
    _, reward, terminated, truncated, info = env.step({"ann": ahead, "bob": ahead})
    assert (reward, terminated) == ({"ann": 1.0, "bob": 0.0}, {"ann": True, "bob": False})
    assert info["ann"]["is_success"]
    assert not any(truncated.values())
    assert env.agents == ["bob"]
    seen, *_ = env.step({"bob": ahead})
    assert list(seen) == ["bob"]
    env.step({"bob": ahead})
    assert env.agents == []
    assert env.step({}) == ({}, {}, {}, {}, {})
    assert env.reset()[0].keys() == {"ann", "bob"}
