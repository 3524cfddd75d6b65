"""Value networks: torch and layers agree, what episodes lead to, and trainings that can be resumed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.diagnostics.errors import ArgumentError
from irsim.learning.tasks.files import TaskError, open_task
from irsim.learning.training.export import export_policy
from irsim.learning.training.run_folder import RunFolder
from irsim.learning.training.sarl.net import ValueNet
from irsim.learning.training.sarl.play import Driver, play
from irsim.learning.training.sarl.task import plan_of
from irsim.learning.training.sarl.train import train_sarl
from irsim.learning.training.settings import SarlSettings, TrainingSettings, read_settings
from irsim.learning.training.train import train
from irsim.learning.worlds import Worlds
from irsim.policies.networks import observe, open_network, save_network
from irsim.policies.networks.sarl import sarl_network
from tests.learning.torch.conftest import assert_resumed_as_whole
from tests.policies.networks.observed import observations
from tests.policies.networks.sarl_weights import sarl_weights

pytestmark = pytest.mark.learn
SMALL = SarlSettings(
    steps=600, demonstrations=4, demonstration_epochs=1, slots=4, batch=50, updates=5, round_episodes=1, memory=300,
    target_updates=3, embed_units=[16, 12], feature_units=[12, 8], score_units=[10], value_units=[16], headings=4,
)  # fmt: skip


def circle(**keys: Any) -> dict[str, Any]:
    """The bundled task with few seeds for validation."""
    task, _ = open_task("sarl_circle")
    seeds = {**task.seeds.model_dump(), "validation_count": 3}
    return {**task.model_dump(mode="json", exclude_unset=True), "seeds": seeds, **keys}


@pytest.mark.parametrize("global_state", [True, False])
def test_torch_and_layers_have_the_same_values(tmp_path: Path, global_state: bool) -> None:
    weights = sarl_weights(global_state)
    net = ValueNet(SarlSettings(global_state=global_state))
    net.load_state_dict({name: torch.from_numpy(x) for name, x in weights.items()})
    save_network(tmp_path / "net.npz", sarl_network(weights, lookahead={}, neighbors=5))
    policy: Any = open_network(tmp_path / "net.npz")
    seen = observations(30)
    observed = observe(policy.head.layout, seen)
    states = np.concatenate([value.flat() for value in observed.values()], axis=1).astype(np.float32)
    with torch.no_grad():
        values = net(torch.from_numpy(states)).numpy()
    np.testing.assert_allclose(values, policy.compute(observed, seen)[:, 0], rtol=1e-5, atol=1e-5)


def test_returns_are_discounted_sums_of_rewards() -> None:
    settings = SarlSettings()
    task, _ = open_task("sarl_circle")
    worlds = Worlds("sarl_circle", 6)
    played = play(worlds, plan_of(task, settings), None, 0.0, np.random.default_rng(0))
    one = played.experience
    assert 0 < played.success.learners <= 1
    ends = np.flatnonzero(one.discount == 0)
    assert len(ends) == 6  # each episode ends once, by an arrival or a collision
    for k in ends:
        assert one.gain[k] == one.reward[k]
        assert 0.9 < one.reward[k] <= 1.0 or -0.3 <= one.reward[k] <= -0.2
    assert set(one.discount.tolist()) == {0.0, float(np.float32(0.9**0.25))}
    assert one.gain.max() <= 1.0 + 1e-6
    assert one.state.shape == (len(one), 6 + 5 * 7)


def test_a_trained_file_drives_as_in_its_training(tmp_path: Path) -> None:
    train_sarl(circle(), tmp_path / "run", SMALL)
    file = export_policy(tmp_path / "run", tmp_path / "net.npz", license="MIT")
    card = (tmp_path / "net.md").read_text()
    assert "sarl" in card
    assert (tmp_path / "net.png").is_file()
    policy: Any = open_network(file)
    assert policy.lookahead.moves.frame == "goal"
    net = ValueNet(SMALL)
    net.load_state_dict(torch.load(tmp_path / "run" / "best.zip", weights_only=True)["net"])
    task, _ = open_task(circle())
    plan = plan_of(task, SMALL)
    worlds = Worlds(circle(), 5)

    def values(states: Any) -> Any:
        with torch.no_grad():
            return net(torch.from_numpy(states)).numpy().astype(float)

    driver = Driver(worlds, plan, values)
    first = driver.moves(worlds.rows, 0.0, np.random.default_rng(0))
    seen = driver._observer.observe(worlds.rows, np.zeros(5, bool), np.arange(5))
    np.testing.assert_allclose(policy.act(seen), first, atol=1e-9)
    (tmp_path / "scene.yaml").write_text((tmp_path / "run" / "scenario.yaml").read_text())
    assert irsim.benchmark(tmp_path / "scene.yaml", policies=[str(file)], seeds=1, workers=1).rows[0].episodes == 1


def test_a_resumed_training_equals_one_that_was_never_interrupted(tmp_path: Path) -> None:
    def weights(file: Path) -> dict[str, Any]:
        return torch.load(file, weights_only=True)["net"]

    assert len(assert_resumed_as_whole(train_sarl, weights, tmp_path, circle(), SMALL)) >= 3


def test_trainings_of_other_algorithms_are_not_mixed_up(tmp_path: Path) -> None:
    train_sarl(circle(), tmp_path / "run", SMALL.model_copy(update={"steps": 1}))
    with pytest.raises(ArgumentError, match="a training with sarl"):
        train("", tmp_path / "run", resume=True)
    RunFolder(tmp_path / "ppo").begin(open_task(circle())[0], tmp_path, {}, TrainingSettings())
    with pytest.raises(ArgumentError, match="a training with ppo"):
        train_sarl("", tmp_path / "ppo", resume=True)
    with pytest.raises(ArgumentError, match="there is no algorithm 'sral'"):
        read_settings({"algo": "sral"}, [])
    assert read_settings({"algo": "sarl"}, ["updates=7"]) == SarlSettings(updates=7)
    with pytest.raises(ArgumentError, match="there is no setting 'entropy'"):
        read_settings({"algo": "sarl"}, ["entropy=0"])


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"observation": [{"name": "goal"}]}, "observes joint states"),
        ({"action": {"returns": "velocity", "frame": "own"}}, "chooses velocities in the world frame"),
        ({"reward": [{"name": "progress"}]}, "progress cannot be predicted"),
    ],
)
def test_tasks_of_something_else_are_refused(changed: dict[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(TaskError, match=message):
        train_sarl(circle(**changed), tmp_path / "run", SMALL)


def test_the_command_trains_and_exports(tmp_path: Path) -> None:
    small = ["demonstrations=2", "demonstration_epochs=1", "slots=2", "updates=1", "round_episodes=1", "headings=2"]
    options = [one for text in [*small, "batch=20"] for one in ("--set", text)]
    folder = str(tmp_path / "run")
    made = CliRunner().invoke(app, ["train", "sarl_circle", "--algo", "sarl", "-o", folder, "--steps", "1", *options])
    assert made.exit_code == 0, made.output
    assert "round 2" in made.output
    out = CliRunner().invoke(app, ["export-policy", folder, "-o", str(tmp_path / "net.npz")])
    assert out.exit_code == 0, out.output
