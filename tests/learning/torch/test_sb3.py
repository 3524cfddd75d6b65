"""Environments of Stable-Baselines3 and TorchRL."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from torchrl.envs.utils import check_env_specs

from irsim.diagnostics.errors import ArgumentError
from irsim.learning import SB3VecEnv, TorchRLEnv, VectorEnv
from tests.learning.tasks import crowd, lidar_among_boxes, task

pytestmark = pytest.mark.learn
CLIMB = {"levels": [{}, {"horizon": 2}], "up": 0.0, "episodes": 8}
"""A curriculum that moves up whatever has been learnt."""


def test_slots_equal_those_of_gymnasium() -> None:
    made = lidar_among_boxes(horizon=1.0)
    env, other = SB3VecEnv(made, 3, seed=5), VectorEnv(made, 3, seed=5, autoreset_mode="SameStep")
    assert np.array_equal(env.reset(), other.reset()[0])
    rng = np.random.default_rng(0)
    ended = 0
    for _ in range(25):
        actions = rng.uniform(-1, 1, (3, 2)).astype(np.float32)
        seen, reward, done, infos = env.step(actions)
        expected, theirs, terminated, truncated, facts = other.step(actions)
        assert np.array_equal(seen, expected)
        assert np.allclose(reward, theirs)
        assert np.array_equal(done, terminated | truncated)
        for slot in np.flatnonzero(done):
            ended += 1
            assert np.array_equal(infos[slot]["terminal_observation"], facts["final_obs"][slot])
            assert infos[slot]["TimeLimit.truncated"] == truncated[slot]
            assert infos[slot]["episode"]["l"] <= 10
    assert ended >= 6


@pytest.mark.parametrize("curriculum", [None, CLIMB], ids=["plain", "curriculum"])
def test_results_do_not_depend_on_the_number_of_workers(curriculum: Any) -> None:
    made = lidar_among_boxes(horizon=1.0, curriculum=curriculum)
    envs = [SB3VecEnv(made, 5, seed=5, workers=workers) for workers in (1, 3)]
    assert np.array_equal(*[env.reset() for env in envs])
    rng = np.random.default_rng(0)
    levels = set()
    for _ in range(60):
        actions = rng.uniform(-1, 1, (5, 2)).astype(np.float32)
        (seen, reward, done, infos), theirs = (env.step(actions) for env in envs)
        assert np.array_equal(seen, theirs[0])
        assert np.array_equal(reward, theirs[1])
        assert np.array_equal(done, theirs[2])
        for one, other in zip(infos, theirs[3], strict=True):
            assert one.keys() == other.keys()
            assert all(np.array_equal(one[key], other[key]) for key in one)
        for env in envs:
            assert env.worlds.level.tolist() == envs[0].worlds.level.tolist()
            levels |= set(env.worlds.level.tolist())
    assert levels == ({0} if curriculum is None else {0, 1})
    for env in envs:
        env.close()


def test_robots_share_a_policy_and_waiting_ones_say_so() -> None:
    near, far = {"state": [8.65, 5, 0]}, {"state": [1, 2, 0], "goal": [9, 2]}
    env = SB3VecEnv(task(near, far, protocol="freeze", horizon=0.4), worlds=2)
    env.reset()
    ahead = np.tile([1.0, 0.0], (4, 1))
    _, _, first, infos = env.step(ahead)
    assert first.tolist() == [True, False, True, False]
    assert infos[0]["is_success"]
    _, reward, second, _ = env.step(ahead)
    assert not second.any()
    assert env.active.tolist() == [False, True, False, True]
    assert reward[0] == 0 < reward[1]
    env.step(ahead)
    *_, last, infos = env.step(ahead)
    assert last.all()
    assert "episode" not in infos[0]
    assert infos[1]["TimeLimit.truncated"]


def test_ppo_learns_to_drive_ahead() -> None:
    made = task({"goal": [4, 5]}, horizon=6, reward=[{"name": "progress"}, {"name": "arrival", "weight": 2.0}])
    env = SB3VecEnv(made, 16)
    model = PPO("MlpPolicy", env, n_steps=32, batch_size=128, learning_rate=1e-3, seed=0, device="cpu")
    before, _ = evaluate_policy(model, SB3VecEnv(made, 1), 1, warn=False)
    model.learn(12_000)
    after, _ = evaluate_policy(model, SB3VecEnv(made, 1), 1, warn=False)
    assert after > before
    assert after > 4.0
    assert model.policy.observation_space.shape == env.observation_space.shape


def test_a_crowd_is_learnt_in() -> None:
    env = SB3VecEnv(crowd(3), 6)
    PPO("MlpPolicy", env, n_steps=16, batch_size=32, device="cpu").learn(200)


@pytest.mark.parametrize("kind", [SB3VecEnv, TorchRLEnv, VectorEnv])
def test_num_envs_counts_the_learners_of_all_worlds(kind: Any) -> None:
    env = kind(crowd(3), num_envs=6)
    assert env.worlds.n == 2
    with pytest.raises(ArgumentError, match="num_envs is 4, and each world has 3 learners"):
        kind(crowd(3), num_envs=4)
    with pytest.raises(TypeError, match=r"'num_env'\. Did you mean 'num_envs'\?"):
        kind(crowd(3), num_env=6)


# TorchRL --------------------------------------------------------------------------------------------------------------
CHOICES = {"choices": [[0, 0], [1, 0], [0.5, 1]]}


@pytest.mark.parametrize(
    "made", [crowd(3, protocol="freeze"), lidar_among_boxes(), lidar_among_boxes(action=CHOICES)],
    ids=["crowd", "controls", "choices"],
)  # fmt: skip
def test_the_check_of_torchrl_passes(made: dict[str, Any]) -> None:
    check_env_specs(TorchRLEnv(made, worlds=2))


@pytest.mark.parametrize("workers", [1, 2])
def test_worlds_equal_those_of_gymnasium(workers: int) -> None:
    made = lidar_among_boxes(horizon=1.0)
    env, other = TorchRLEnv(made, 3, seed=5, workers=workers), VectorEnv(made, 3, seed=5, autoreset_mode="SameStep")
    data, (seen, _) = env.reset(), other.reset()
    assert np.array_equal(data["observation"].numpy(), seen)
    rng = np.random.default_rng(0)
    for _ in range(25):
        actions = rng.uniform(-1, 1, (3, 2)).astype(np.float32)
        data["action"] = torch.from_numpy(actions)
        stepped, data = env.step_and_maybe_reset(data)
        seen, reward, terminated, truncated, _ = other.step(actions)
        assert np.array_equal(data["observation"].numpy(), seen)
        assert np.allclose(stepped["next", "reward"].numpy()[:, 0], reward)
        assert np.array_equal(stepped["next", "terminated"].numpy()[:, 0], terminated)
        assert np.array_equal(stepped["next", "truncated"].numpy()[:, 0], truncated)
    env.close()
