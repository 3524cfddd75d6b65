"""The folder of a training: its files, and which round is the best."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

import pytest
import yaml
from PIL import Image

import irsim
from irsim.cli.train import SARL_SETTINGS, SETTINGS
from irsim.diagnostics.errors import ArgumentError
from irsim.learning.tasks.files import open_task
from irsim.learning.training.run_folder import RunFolder, merit
from irsim.learning.training.settings import SarlSettings, TrainingSettings
from irsim.learning.worlds import Worlds
from tests.learning.tasks import corridor, task


def test_more_success_is_better_and_with_equal_success_more_reward() -> None:
    rounds = [{"learners": 0.9, "reward": 5.0}, {"learners": 1.0, "reward": 2.0}, {"learners": 1.0, "reward": 3.0}]
    assert max(rounds, key=merit) is rounds[2]
    assert max(rounds[:2], key=merit) is rounds[1]


def test_the_scenario_of_a_task_is_kept_with_its_maps(tmp_path: Path) -> None:
    made = task(world={"obstacle_map": "maps/hall.png"}, protocol="freeze")
    (tmp_path / "maps").mkdir()
    Image.new("L", (20, 20), 255).save(tmp_path / "maps" / "hall.png")
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(made.pop("scenario")))
    (tmp_path / "task.yaml").write_text(yaml.safe_dump({**made, "file": "scene.yaml"}))
    opened, folder = open_task(tmp_path / "task.yaml")
    maps = Worlds(tmp_path / "task.yaml").scenario.map_files
    RunFolder(tmp_path / "run").begin(opened, folder, maps, TrainingSettings())
    assert irsim.validate(tmp_path / "run" / "scenario.yaml").valid
    assert yaml.safe_load((tmp_path / "run" / "scenario.yaml").read_text())["world"]["after_arrival"] == "freeze"
    assert Worlds(tmp_path / "run" / "task.yaml").scenario.map_files["maps/hall.png"].startswith(str(tmp_path / "run"))


def test_a_folder_holds_one_training_at_a_time(tmp_path: Path) -> None:
    opened, folder = open_task(corridor())
    first, second = RunFolder(tmp_path / "run"), RunFolder(tmp_path / "run")
    first.begin(opened, folder, {}, TrainingSettings())
    with pytest.raises(ArgumentError, match="another training writes"):
        second.begin(opened, folder, {}, TrainingSettings())
    del first
    RunFolder(tmp_path / "run").begin(opened, folder, {}, TrainingSettings())


def test_a_training_goes_on_with_its_own_settings_and_another_number_of_steps(tmp_path: Path) -> None:
    opened, folder = open_task(corridor())
    first = RunFolder(tmp_path / "run")
    started = first.settings_for(TrainingSettings, TrainingSettings(rate=1e-3), None, resume=False)
    first.begin(opened, folder, {}, started)
    again = first.settings_for(TrainingSettings, None, 7000, resume=True)
    assert (again.rate, again.steps) == (1e-3, 7000)
    assert first.settings_for(TrainingSettings, None, None, resume=True) == again
    with pytest.raises(ArgumentError, match="holds a training with ppo"):
        first.settings_for(SarlSettings, None, None, resume=True)


def test_the_scenario_of_a_template_is_kept_too(tmp_path: Path) -> None:
    opened, folder = open_task(corridor())
    RunFolder(tmp_path / "run").begin(opened, folder, {}, TrainingSettings())
    assert irsim.validate(tmp_path / "run" / "scenario.yaml").valid


def test_the_help_of_train_has_every_setting_with_its_default() -> None:
    options = {"algo", "steps", "seed", "stop_at"}
    settings = TrainingSettings().model_dump(exclude=options)
    assert SETTINGS.endswith(": " + ", ".join(f"{key}={value}" for key, value in settings.items()) + ".")
    sarl = SarlSettings().model_dump(exclude=options)
    assert SARL_SETTINGS.endswith(": " + ", ".join(f"{key}={value}" for key, value in sarl.items()) + ".")


def test_a_training_without_a_finished_round_does_not_block_its_folder(tmp_path: Path) -> None:
    opened, folder = open_task(corridor())
    run = RunFolder(tmp_path / "run")
    run.begin(opened, folder, {}, TrainingSettings(seed=1))
    run.begin(opened, folder, {}, TrainingSettings(seed=2))
    assert run.settings().seed == 2


class Model:
    """A model of two bytes for each round."""

    def __init__(self, content: bytes) -> None:
        self.content = content

    def save(self, file: Any) -> None:
        file.write(self.content)


@pytest.mark.parametrize("step", ["model", "progress", "name"])
def test_a_training_that_stops_while_it_saves_goes_on_from_its_last_finished_round(
    step: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each step of saving a round fails, and what is read again is of one round."""
    run, facts = RunFolder(tmp_path), {"learners": 0.5, "reward": 1.0}
    run.save(Model(b"r1"), facts, best=True)
    names = {"model": ("next-2.zip", "latest.zip"), "progress": ("progress.jsonl",), "name": ("latest.zip",)}[step]
    rename = os.replace

    def full(source: Any, target: Any) -> None:
        if Path(target).name in names:
            raise OSError(errno.ENOSPC, "No space left on device", str(target))
        rename(source, target)

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", full)
        with pytest.raises(OSError, match="No space"):
            run.save(Model(b"r2"), facts, best=False)
    rounds = len(run.rounds())
    assert rounds == (2 if step == "name" else 1)
    assert run.settle().read_bytes() == f"r{rounds}".encode()
    run.save(Model(b"r9"), facts, best=False)
    assert (len(run.rounds()), run.settle().read_bytes()) == (rounds + 1, b"r9")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["best.zip", "latest.zip", "progress.jsonl"]


def test_what_a_killed_training_left_is_deleted(tmp_path: Path) -> None:
    run = RunFolder(tmp_path)
    run.save(Model(b"r1"), {}, best=True)
    for name in (".latest.123-7f.zip", ".next-2.123-7f.zip", "next-2.zip"):
        (tmp_path / name).write_bytes(b"half")
    assert run.settle().read_bytes() == b"r1"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["best.zip", "latest.zip", "progress.jsonl"]
