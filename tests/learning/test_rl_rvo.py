"""The task of RL-RVO: learners observe what a policy file with the same parts does."""

from __future__ import annotations

from typing import Any

import numpy as np

from irsim.learning import Worlds
from irsim.policies.networks.layout import layout_needs, observe
from irsim.policies.observe import Observer


def test_learners_observe_what_a_network_observes_and_their_last_velocity() -> None:
    worlds = Worlds("rl_rvo", 3)
    simulation, rows = worlds.simulation, worlds.rows
    observer = Observer(simulation, layout_needs(worlds.task.layout), rows % simulation.objects)
    rng = np.random.default_rng(5)
    urgent = 0
    for _ in range(40):
        before = simulation.twist[rows, :2].copy()
        actions = rng.uniform(-1, 1, (len(rows), 2))
        active = ~worlds._stepper.ended.reshape(-1)
        worlds.step(actions)
        seen = observer.observe(rows, np.zeros(len(rows), bool), rows // simulation.objects)
        assert seen.commanded is not None
        np.testing.assert_array_equal(seen.commanded[active], (before + 0.5 * actions)[active])
        parts = observe(worlds.task.layout, seen)
        flat = np.concatenate([value.flat() for value in parts.values()], axis=1).astype(np.float32)
        np.testing.assert_array_equal(worlds.observe(), flat)
        urgent += int((parts["rvo_cones"].array[:, :, 7] > 0).sum())
    assert urgent > 0


def two(*, reward: dict[str, Any], apart: float = 4.0, action: Any = None) -> Worlds:
    """Two discs of 0.2 m that face each other, each with its goal behind the other."""
    robot = {
        "kinematics": {"name": "omni"},
        "shape": {"name": "circle", "radius": 0.2},
        "vel_min": [-1, -1],
        "vel_max": [1, 1],
    }
    scene = {
        "world": {"width": 20, "height": 20, "step_time": 0.1, "collision_mode": "stop"},
        "robot": [{**robot, "state": [5, 5], "goal": [15, 5]}, {**robot, "state": [5 + apart, 5], "goal": [0, 5]}],
    }
    given = {"returns": "velocity", "low": [-1, -1], "high": [1, 1]} if action is None else action
    return Worlds({"task": "two", "scenario": scene, "observation": [{"name": "goal"}], "reward": [reward],
                   "action": given, "horizon": 5})  # fmt: skip


def test_the_reward_of_rl_rvo_by_hand() -> None:
    ahead, back = [[1.0, 0.0], [-1.0, 0.0]], [[-1.0, 0.0], [1.0, 0.0]]
    worlds = two(reward={"name": "rvo"}, apart=3.5)
    still = worlds.step(ahead).reward[0]  # velocity obstacles of two that stand: 3 m at 1 m/s
    np.testing.assert_allclose(still, 0.3 - 6 * 0.2 / 3.2, rtol=1e-6)
    moving = worlds.step(ahead).reward[0]  # 2 (1) - 1 + 1 = 2 m/s; 2.8 m are left
    np.testing.assert_allclose(moving, 0.3 - 6 * 0.2 / (1.4 + 0.2), rtol=1e-6)
    away = worlds.step(back).reward[0]
    np.testing.assert_allclose(away, 0.3 - 3 * 2 / 3, rtol=1e-6)
    far = two(reward={"name": "rvo"}, apart=4.5).step([[0.6, 0.8], [-0.6, 0.8]]).reward[0]
    np.testing.assert_allclose(far, 0.3 - 3 * np.hypot(0.4, 0.8) / 3, rtol=1e-6)
    sudden = two(reward={"name": "rvo", "weight": 0.5}, apart=0.55).step(ahead).reward[0]
    np.testing.assert_allclose(sudden, 0.5 * (0.3 - 3 * 6 * 0.2 / (0.05 + 0.2)), rtol=1e-6)


def test_controls_command_no_velocity() -> None:
    worlds = two(reward={"name": "rvo"}, apart=4.5, action={"returns": "control"})
    np.testing.assert_allclose(worlds.step([[1.0, 0.0], [-1.0, 0.0]]).reward[0], 0.3 - 3 * 1 / 3)
