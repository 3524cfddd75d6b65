"""The task of RL-RVO: learners observe what a policy file with the same parts does."""

from __future__ import annotations

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
        active = ~worlds._ended.reshape(-1)
        worlds.step(actions)
        seen = observer.observe(rows, np.zeros(len(rows), bool), rows // simulation.objects)
        assert seen.commanded is not None
        np.testing.assert_array_equal(seen.commanded[active], (before + 0.5 * actions)[active])
        parts = observe(worlds.task.layout, seen)
        flat = np.concatenate([value.flat() for value in parts.values()], axis=1).astype(np.float32)
        np.testing.assert_array_equal(worlds.observe(), flat)
        urgent += int((parts["rvo_cones"].array[:, :, 7] > 0).sum())
    assert urgent > 0
