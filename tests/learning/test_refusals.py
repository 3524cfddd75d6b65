"""Environments of learners refuse what programs give them by mistake, with a sentence and a fix."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from gymnasium.error import ResetNeeded

import irsim
from irsim.diagnostics.errors import InputError
from irsim.learning import Env, VectorEnv
from tests.learning.tasks import task


@pytest.mark.parametrize("data", [None, b"", b"abc", {}, 5, "x", b"\x80\x05N.", b"\x80\x05K\x01K\x02\x86."])
def test_snapshots_that_are_none_are_refused(data: Any) -> None:
    env = Env(task())
    env.reset(seed=1)
    whole = env.snapshot()
    for one in (data, whole[: len(whole) // 2], env.worlds.snapshot()):
        with pytest.raises(InputError, match="snapshot"):
            env.restore(one)
        with pytest.raises(InputError, match="snapshot"):
            env.worlds.restore(one if one != env.worlds.snapshot() else data)
    env.restore(whole)


@pytest.mark.parametrize("make", [Env, lambda task: VectorEnv(task, 3)])
def test_a_step_before_the_first_episode_asks_for_reset(make: Any) -> None:
    env = make(task())
    with pytest.raises(ResetNeeded, match="no episode has begun; call reset"):
        env.step(np.zeros(env.action_space.shape))
    env.reset()
    env.step(np.zeros(env.action_space.shape))


@pytest.mark.parametrize("action", ["abc", {}, None, [1j, 0], [[1], [1, 2]], [None, 1.0]])
def test_actions_that_are_no_numbers_are_refused(action: Any) -> None:
    env = Env(task())
    env.reset()
    with pytest.raises(InputError, match="action"):
        env.step(action)


@pytest.mark.parametrize("seed", [2**64, 2**70])
def test_seeds_beyond_64_bits_are_refused(seed: int) -> None:
    env = Env(task())
    with pytest.raises(ValueError, match="seed"):
        env.reset(seed=seed)
    with pytest.raises(ValueError, match="seed"):
        VectorEnv(task(), 2, seed=seed - 1)


@pytest.mark.parametrize("count", [0, -1, 10**12, 2.5, "many", None])
def test_numbers_of_worlds_that_nothing_holds_are_refused(count: Any) -> None:
    with pytest.raises(InputError):
        VectorEnv(task(), count)
    with pytest.raises(InputError):
        irsim.batch("templates/cave/scenario.yaml", count)
