"""RL-RVO in torch and without it: converted and exported policies decide alike."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from stable_baselines3 import PPO
from torch import nn

from irsim.learning import Worlds
from irsim.learning.training.export import export_policy
from irsim.learning.training.settings import TrainingSettings
from irsim.learning.training.train import train
from irsim.policies.converters.convert import convert_policy
from irsim.policies.networks import open_network
from irsim.policies.networks.layout import layout_needs, observe
from irsim.policies.observe import Observer
from tests.policies.networks.observed import observations

pytestmark = pytest.mark.learn
SMALL = TrainingSettings(steps=2 * 20 * 8, slots=20, rollout=8, batch=64, epochs=1, round_updates=1, units=[16],
                         set_units=[12], set_reader="gru")  # fmt: skip


class Reader(nn.Module):
    """The part of RL-RVO's network that reads the others, written anew."""

    def __init__(self, units: int) -> None:
        super().__init__()
        self.rnn_net = nn.GRU(8, units, batch_first=True, bidirectional=True)
        self.ln = nn.LayerNorm(6 + units)

    def forward(self, own: Any, cones: Any) -> Any:
        _, last = self.rnn_net(cones[None])
        return self.ln(torch.cat([own, last[:, 0].sum(dim=0)]))


class Actor(nn.Module):
    def __init__(self, reader: Reader, units: int) -> None:
        super().__init__()
        self.rnn_reader = reader
        layers = [nn.Linear(6 + units, 256), nn.ReLU(), nn.Linear(256, 256), nn.ReLU(), nn.Linear(256, 2), nn.Tanh()]
        self.net_out = nn.Sequential(*layers)
        self.log_std = nn.Parameter(torch.full((2,), -1.14))


class ActorAndCritic(nn.Module):
    def __init__(self, units: int = 256) -> None:
        super().__init__()
        reader = Reader(units)
        self.pi = Actor(reader, units)
        self.v = nn.ModuleDict({"v_net": nn.Sequential(nn.Linear(6 + units, 16), nn.ReLU(), nn.Linear(16, 1)),
                                "rnn_reader": reader})  # fmt: skip


@pytest.mark.parametrize("form", ["state", "checkpoint", "module", "old module"])
def test_a_converted_policy_decides_as_torch_does(form: str, tmp_path: Path) -> None:
    torch.manual_seed(3)
    net = ActorAndCritic()
    saved = {"state": net.state_dict(), "checkpoint": {"model_state": net.state_dict(), "epoch": 1000}}.get(form, net)
    torch.save(saved, tmp_path / "net.pt", _use_new_zipfile_serialization=form != "old module")
    convert_policy("rl_rvo", tmp_path / "net.pt", tmp_path / "net.npz")
    policy = open_network(tmp_path / "net.npz")
    seen = observations(60, neighbors=32)
    velocities, parts = policy.act(seen), observe(policy.head.layout, seen)
    mask = parts["rvo_cones"].mask
    assert mask is not None
    for b in range(60):
        own, cones = (torch.tensor(parts[name].array[b], dtype=torch.float32) for name in ("rvo_self", "rvo_cones"))
        with torch.no_grad():
            change = net.pi.net_out(net.pi.rnn_reader(own, cones[torch.tensor(mask[b])])).numpy()
        np.testing.assert_allclose(velocities[b] - seen.velocity[b], change, atol=1e-5)


def test_an_exported_gru_decides_as_in_its_training(tmp_path: Path) -> None:
    train("rl_rvo", tmp_path / "run", SMALL)
    model = PPO.load(tmp_path / "run" / "best.zip", device="cpu")
    policy = open_network(export_policy(tmp_path / "run", tmp_path / "out.npz"))
    worlds = Worlds("rl_rvo", 6)
    observer = Observer(worlds.simulation, layout_needs(worlds.task.layout), worlds.rows % worlds.simulation.objects)
    nobody = 0
    for _ in range(60):
        flat = worlds.observe()
        seen = observer.observe(worlds.rows, np.zeros(len(worlds.rows), bool), worlds.rows // 10)
        change = 0.5 * np.clip(model.predict(flat, deterministic=True)[0], -1, 1)
        assert seen.commanded is not None
        np.testing.assert_allclose(policy.act(seen) - seen.velocity, change, atol=1e-5)
        nobody += int((flat[:, 8:] == 0).all(axis=1).sum())
        worlds.step(np.random.default_rng(nobody).uniform(-1, 1, change.shape))
    assert nobody > 0
    assert seen.commanded.any()
