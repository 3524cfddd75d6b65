"""A disk that fills during a training: it is said, and the training goes on as one that was never interrupted."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

import pytest
import torch
import yaml
from stable_baselines3 import PPO

from irsim.learning.training.sarl.train import train_sarl
from irsim.learning.training.settings import TrainingSettings
from irsim.learning.training.train import train
from tests.disks import assert_said_and_nothing_left, disk
from tests.learning.tasks import lidar_among_boxes
from tests.learning.torch import test_sarl
from tests.learning.torch.conftest import assert_equal_weights, results

__all__ = ["disk"]

pytestmark = pytest.mark.learn
SMALL = TrainingSettings(steps=4 * 2 * 16 * 4, slots=8, rollout=16, batch=64, epochs=1, round_updates=1, units=[8])
TASK = lidar_among_boxes(seeds={"validation_count": 4})


def ppo_weights(file: Path) -> dict[str, Any]:
    return dict(PPO.load(file, device="cpu").policy.state_dict())


def sarl_weights(file: Path) -> dict[str, Any]:
    return dict(torch.load(file, weights_only=True)["net"])


ALGORITHMS = {
    "ppo": (train, TASK, SMALL, ppo_weights),
    "sarl": (train_sarl, test_sarl.circle(), test_sarl.SMALL, sarl_weights),
}


@pytest.mark.parametrize("file", ["next-2.zip", "progress.jsonl", "latest.zip"])
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_training_goes_on_after_a_full_disk(
    algorithm: str, file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run, task, settings, weights = ALGORITHMS[algorithm]
    rename, count = os.replace, [0]

    def full(source: Any, target: Any) -> None:
        count[0] += Path(target).name == file
        if Path(target).name == file and (count[0] == 2 or file == "next-2.zip"):
            raise OSError(errno.ENOSPC, "No space left on device", str(target))
        rename(source, target)

    run(task, tmp_path / "whole", settings)
    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", full)
        with pytest.raises(OSError, match="No space left"):
            run(task, tmp_path / "full", settings)
    run("", tmp_path / "full", resume=True)
    assert results(tmp_path / "whole") == results(tmp_path / "full")
    for name in ("latest.zip", "best.zip"):
        assert_equal_weights(*(weights(tmp_path / folder / name) for folder in ("whole", "full")))
    assert not [*(tmp_path / "full").glob("next-*"), *(tmp_path / "full").glob(".*")]


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_full_disk_is_said(algorithm: str, disk: Path, tmp_path: Path) -> None:
    (tmp_path / "task.yaml").write_text(yaml.safe_dump(ALGORITHMS[algorithm][1]))
    command = f"train {tmp_path / 'task.yaml'} --algo {algorithm} --steps 64 -o {{disk}}/run"
    assert_said_and_nothing_left(command, disk, hidden_only=True)
