"""Environments of TorchRL."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch
from torchrl.envs.utils import check_env_specs

from irsim.learning import TorchRLEnv, VectorEnv
from tests.learning.tasks import crowd, lidar_among_boxes

pytestmark = pytest.mark.learn
CHOICES = {"choices": [[0, 0], [1, 0], [0.5, 1]]}


@pytest.mark.parametrize(
    "made", [crowd(3, protocol="freeze"), lidar_among_boxes(), lidar_among_boxes(action=CHOICES)],
    ids=["crowd", "controls", "choices"],
)  # fmt: skip
def test_the_check_of_torchrl_passes(made: dict[str, Any]) -> None:
    check_env_specs(TorchRLEnv(made, 2))


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
