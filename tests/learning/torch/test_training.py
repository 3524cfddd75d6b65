"""Training: rounds that can be resumed, and policies that run without torch."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
import yaml
from stable_baselines3 import PPO
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.diagnostics.errors import ArgumentError
from irsim.learning import SB3VecEnv, Worlds
from irsim.learning.training.export import export_policy, network_of
from irsim.learning.training.extractor import PartsExtractor, columns_of
from irsim.learning.training.settings import TrainingSettings, read_settings
from irsim.learning.training.train import MaskedRolloutBuffer, train
from irsim.policies.networks import open_network, save_network
from irsim.policies.networks.layout import layout_needs, observe
from irsim.policies.observe import Observer
from tests.learning.tasks import ROBOT, crowd, lidar_among_boxes, task
from tests.learning.torch.conftest import assert_equal_weights, assert_resumed_as_whole, results

pytestmark = pytest.mark.learn
SMALL = TrainingSettings(steps=4 * 2 * 16 * 8, slots=8, rollout=16, batch=64, epochs=2, round_updates=2, units=[16, 16])
FEW = {"validation_count": 6}


def weights(file: Path) -> dict[str, Any]:
    return dict(PPO.load(file, device="cpu").policy.state_dict())


@pytest.mark.parametrize("made", [lidar_among_boxes(seeds=FEW), crowd(3, seeds=FEW)], ids=["lidar", "crowd"])
def test_a_resumed_training_equals_one_that_was_never_interrupted(made: dict[str, Any], tmp_path: Path) -> None:
    whole = assert_resumed_as_whole(train, weights, tmp_path, made, SMALL)
    assert [one["round"] for one in whole] == [1, 2, 3, 4]


def test_workers_change_nothing(tmp_path: Path) -> None:
    made = lidar_among_boxes(seeds=FEW)
    for workers in (1, 2):
        train(made, tmp_path / str(workers), SMALL.model_copy(update={"steps": 256}), workers=workers)
    assert results(tmp_path / "1") == results(tmp_path / "2")
    assert_equal_weights(*(weights(tmp_path / name / "latest.zip") for name in ("1", "2")))


def test_other_seeds_learn_otherwise(tmp_path: Path) -> None:
    made = lidar_among_boxes(seeds=FEW)
    for seed in (0, 1):
        train(made, tmp_path / str(seed), SMALL.model_copy(update={"seed": seed, "steps": 256}))
    a, b = (weights(tmp_path / name / "latest.zip") for name in ("0", "1"))
    assert not all(torch.equal(a[key], b[key]) for key in a)


def test_a_training_stops_at_a_success_and_stays_stopped(tmp_path: Path) -> None:
    easy = task({"state": [8, 5, 0]}, horizon=6, seeds=FEW, reward=[{"name": "progress"}])
    train(easy, tmp_path / "a", SMALL.model_copy(update={"stop_at": 0.0}))
    assert len(results(tmp_path / "a")) == 1
    train("", tmp_path / "a", resume=True)
    assert len(results(tmp_path / "a")) == 1


def test_folders_are_not_mixed_up(tmp_path: Path) -> None:
    with pytest.raises(ArgumentError, match="holds no training"):
        train("", tmp_path, resume=True)
    train(task(seeds=FEW), tmp_path / "a", SMALL.model_copy(update={"steps": 1}))
    with pytest.raises(ArgumentError, match="holds a training"):
        train(task(seeds=FEW), tmp_path / "a", SMALL)
    with pytest.raises(ArgumentError, match="no finished round"):
        export_policy(tmp_path / "nothing", tmp_path / "a.npz")


@pytest.mark.parametrize(
    "made", [lidar_among_boxes(), crowd(4), crowd(4, action={"choices": [[0, 0], [1, 0], [0.5, 1]]})],
    ids=["vectors", "sets", "choices"],
)  # fmt: skip
def test_exported_policies_decide_as_torch_does(made: dict[str, Any], tmp_path: Path) -> None:
    env = SB3VecEnv(made, worlds=3)
    columns = columns_of(env.worlds.eyes, env.worlds.task.observation)
    kwargs = {"features_extractor_class": PartsExtractor, "features_extractor_kwargs": {"columns": columns}}
    sets = any(part.members for part in columns)
    model = PPO("MlpPolicy", env, policy_kwargs={"net_arch": [32], **(kwargs if sets else {})}, device="cpu", seed=3)
    save_network(tmp_path / "policy.npz", network_of(model.policy, made))
    policy: Any = open_network(tmp_path / "policy.npz")
    worlds, layout = env.worlds, env.worlds.task.layout
    observer = Observer(worlds.simulation, layout_needs(layout), np.arange(worlds.learners))
    for _ in range(20):
        seen = worlds.observe()
        first = np.zeros(len(worlds.rows), dtype=bool)
        observed = observer.observe(worlds.rows, first, worlds.rows // worlds.simulation.objects)
        numbers = policy.compute(observe(layout, observed), observed)
        with torch.no_grad():
            expected = model.policy.get_distribution(torch.as_tensor(seen)).distribution
        theirs = expected.logits if hasattr(expected, "logits") else expected.mean
        mine = numbers - numbers.mean(axis=1, keepdims=True) if hasattr(expected, "logits") else numbers
        theirs = theirs - theirs.mean(dim=1, keepdim=True) if hasattr(expected, "logits") else theirs
        np.testing.assert_allclose(mine, theirs.numpy(), atol=1e-5)
        worlds.step(model.predict(seen, deterministic=True)[0])


def test_an_exported_policy_drives_as_in_its_environment(tmp_path: Path) -> None:
    made = lidar_among_boxes(seeds=FEW)
    train(made, tmp_path / "run", SMALL.model_copy(update={"steps": 1}))
    file = export_policy(tmp_path / "run", tmp_path / "policy.npz", license="MIT")
    assert file.stat().st_size < 1_000_000
    card = file.with_suffix(".md").read_text()
    assert "MIT" in card
    assert "test version 1" in card
    model = PPO.load(tmp_path / "run" / "best.zip", device="cpu")
    worlds = Worlds(made, 1, seed=5)
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(made["scenario"]))
    batch = irsim.batch(tmp_path / "scene.yaml", 1, seeds=[5], policy=str(file))
    for _ in range(30):
        result = worlds.step(model.predict(worlds.observe(), deterministic=True)[0])
        if result.over.any():
            break
        batch.step()
        np.testing.assert_allclose(batch.pose[0], worlds.simulation.pose, atol=1e-4)


def test_an_exported_onnx_model_decides_as_the_file_of_irsim(tmp_path: Path) -> None:
    made = crowd(3, seeds=FEW)
    train(made, tmp_path / "run", SMALL.model_copy(update={"steps": 1}))
    files = [export_policy(tmp_path / "run", tmp_path / f"policy{suffix}") for suffix in (".npz", ".onnx")]
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(made["scenario"]))
    ours, theirs = (irsim.batch(tmp_path / "scene.yaml", 2, seeds=[5, 6], policy=str(file)) for file in files)
    for _ in range(20):
        ours.step()
        theirs.step()
        np.testing.assert_allclose(ours.pose, theirs.pose, atol=1e-3)


def test_waiting_slots_are_not_learnt_from() -> None:
    env = SB3VecEnv(task({"state": [8.65, 5, 0]}, {"state": [1, 2, 0], "goal": [9, 2]}, protocol="freeze"), worlds=1)
    buffer = MaskedRolloutBuffer(4, env.observation_space, env.action_space, device="cpu", n_envs=2)
    buffer.reset()
    for step in range(4):
        buffer.now = np.array([step < 1, True])
        value = torch.full((2,), float(step))
        seen = np.full((2, env.worlds.eyes.size), step, dtype=np.float32)
        buffer.add(seen, np.zeros((2, 2)), np.zeros(2), np.zeros(2), value, torch.zeros(2))
    samples = list(buffer.get(3))
    assert [len(one.observations) for one in samples] == [3, 2]
    assert sorted(float(row[0]) for one in samples for row in one.observations) == [0, 0, 1, 2, 3]


def test_settings_are_read_from_texts() -> None:
    assert read_settings({"steps": 10, "stop_at": None}, ["rate=3e-4", "units=[8]"]).rate == pytest.approx(3e-4)
    with pytest.raises(ArgumentError, match=r"did you mean rate"):
        read_settings({}, ["rat=1"])
    with pytest.raises(ArgumentError, match=r"clip"):
        read_settings({}, ["clip=-1"])


def test_the_commands_train_and_export(tmp_path: Path) -> None:
    (tmp_path / "task.yaml").write_text(yaml.safe_dump(task({**ROBOT, "goal": [3, 5]}, horizon=4, seeds=FEW)))
    sets = [word for key in ("slots=4", "rollout=8", "batch=16", "round_updates=1") for word in ("--set", key)]
    run = CliRunner()
    folder = str(tmp_path / "training")
    done = run.invoke(app, ["train", str(tmp_path / "task.yaml"), "-o", folder, "--steps", "64", *sets])
    assert done.exit_code == 0, done.output
    assert "round 2/2" in done.output
    again = run.invoke(app, ["train", "--resume", "-o", folder])
    assert again.exit_code == 0, again.output
    more = run.invoke(app, ["train", "--resume", "-o", folder, "--steps", "96"])
    assert "round 3/3" in more.output
    late = run.invoke(app, ["train", "--resume", "-o", folder, "--steps", "320", "--max-time", "0"])
    assert late.exit_code == 0, late.output
    assert "round 4" not in late.output
    refused = run.invoke(app, ["train", "--resume", "-o", folder, "--seed", "3"])
    assert refused.exit_code == 2
    assert "keeps its settings" in refused.output
    file = tmp_path / "policy.npz"
    assert run.invoke(app, ["export-policy", folder, "-o", str(file)]).exit_code == 0
    assert run.invoke(app, ["export-policy", folder, "-o", str(file)]).exit_code == 2  # it exists
    assert run.invoke(app, ["export-policy", folder, "-o", str(file), "--force"]).exit_code == 0
    described = run.invoke(app, ["policies", str(file), "--json"])
    assert json.loads(described.output)["drives"] == ["diff"]
    wrong = run.invoke(app, ["train", "-o", folder])
    assert wrong.exit_code == 2


def test_a_training_rises_through_the_levels_and_resumes_on_its_level(tmp_path: Path) -> None:
    levels = [{"horizon": 1}, {"horizon": 2, "randomize": {"number": {"learners": [1, 2]}}}, {}]
    curriculum = {"levels": levels, "up": 0.02, "episodes": 60}
    made = task({"state": [8.55, 5, 0]}, {"state": [8.5, 3, 0], "goal": [9, 3]}, horizon=2, seeds=FEW)
    made |= {"curriculum": curriculum, "randomize": {"speed": {"learners": [0.5, 1.0]}}}
    whole = assert_resumed_as_whole(train, weights, tmp_path, made, SMALL)
    assert len({one["level"] for one in whole}) > 1
    assert {one["level"] for one in whole} <= {0, 1, 2}


def test_a_policy_that_observes_draws_is_trained_and_not_exported(tmp_path: Path) -> None:
    made = crowd(3, seeds=FEW, randomize={"latency": {"learners": [0, 2]}, "observed": ["latency"]})
    train(made, tmp_path / "run", SMALL.model_copy(update={"steps": 256}))
    with pytest.raises(ArgumentError, match=r"only a simulation knows.*without randomize.observed"):
        export_policy(tmp_path / "run", tmp_path / "a.npz")
