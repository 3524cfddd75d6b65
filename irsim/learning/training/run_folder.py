"""The folder of a training: what it was asked for, what it has reached, and what it needs to go on."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar
from weakref import finalize

import yaml
from pydantic import ValidationError

from irsim.common.files import replacing, write_atomically
from irsim.common.records import ContentError, read_json_lines
from irsim.common.text import clean
from irsim.common.yaml.plain import read_plain_yaml
from irsim.diagnostics.errors import ArgumentError
from irsim.learning.tasks.scene import scenario_text
from irsim.learning.tasks.task import Task
from irsim.learning.training.settings import AnySettings, SarlSettings, TrainingSettings, settings_class
from irsim.runs.files import lock_file
from irsim.scenario.messages.translate import option_message, option_problems

S = TypeVar("S", TrainingSettings, SarlSettings)
__all__ = ["SETTINGS_FILE", "RunFolder", "merit"]

SETTINGS_FILE = "settings.yaml"
"""The settings of a training: a folder that has them can go on."""


def merit(facts: Mapping[str, Any]) -> tuple[float, float]:
    """How good a round is: the success of its learners and, between equal ones, their reward."""
    return facts["learners"], facts["reward"]


class RunFolder:
    """Files of a training.

    ``task.yaml``, its scenario ``scenario.yaml`` and ``settings.yaml`` say what was asked for, ``progress.jsonl`` has a
    line for each round, ``latest.zip`` and ``best.zip`` are models of the algorithm. The model of a round is
    ``next-N.zip`` until ``progress.jsonl`` has its line, so that a training goes on from the last finished round.

    Args:
        path: The folder.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.latest, self.best = path / "latest.zip", path / "best.zip"
        self._claimed = False
        self._progress = path / "progress.jsonl"

    def claim(self) -> None:
        """Keep other programs from training in the folder, until this object or this process ends.

        Raises:
            ArgumentError: Another training writes to the folder.
        """
        if self._claimed:
            return
        self.path.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(self.path / "lock", os.O_CREAT | os.O_RDWR, 0o600)
        finalize(self, os.close, descriptor)
        if lock_file(descriptor, wait=False, alone=True) is False:
            what = f"another training writes to {clean(self.path, 200)}"
            raise ArgumentError(what, "name another folder with -o, or wait for its end")
        self._claimed = True

    def begin(self, task: Task, folder: Path, maps: Mapping[str, str], settings: AnySettings) -> None:
        """Write what was asked for.

        Args:
            task: The task.
            folder: Where the file of its scenario is found.
            maps: Names of files that the scenario reads -> their paths. Files with relative names are copied.
            settings: The settings.

        Raises:
            ArgumentError: The folder holds a training that has finished a round.
        """
        if self.has_rounds():
            raise ArgumentError(
                f"{self.path} holds a training", "resume it with --resume, or name another folder with -o"
            )
        self.claim()
        data = task.model_dump(mode="json", exclude_unset=True)
        if task.file is not None:
            data["file"] = "scenario.yaml"
        write_atomically(self.path / "scenario.yaml", scenario_text(task, folder))
        for name, file in maps.items():
            copy = self.path / name
            if not Path(name).is_absolute() and copy.resolve().is_relative_to(self.path.resolve()):
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(file, copy)
        write_atomically(self.path / "task.yaml", yaml.safe_dump(data, sort_keys=False, allow_unicode=True))
        self.keep(settings)

    def keep(self, settings: AnySettings) -> None:
        """Write the settings."""
        text = yaml.safe_dump(settings.model_dump(mode="json"), sort_keys=False)
        write_atomically(self.path / SETTINGS_FILE, text)

    def settings(self) -> AnySettings:
        """The settings of the training in the folder.

        Raises:
            ArgumentError: The folder holds no training.
        """
        file = self.path / SETTINGS_FILE
        if not file.is_file():
            raise ArgumentError(f"{self.path} holds no training", "leave out --resume to begin one")
        try:
            data = read_plain_yaml(file)
            if not isinstance(data, dict):
                raise ContentError("it is not a mapping")
            return settings_class(str(data.get("algo"))).model_validate(data)
        except ContentError as error:
            raise _damaged(file, error.message) from None
        except ValidationError as error:
            message, _ = option_message(option_problems(error, data, settings_class(str(data["algo"]))))
            raise _damaged(file, message) from None

    def settings_for(self, kind: type[S], given: S | None, steps: int | None, *, resume: bool) -> S:
        """The settings of a training that begins or goes on.

        Args:
            kind: Their class.
            given: Settings of a training that begins; None for the usual ones.
            steps: Another number of steps; None keeps the number of the settings.
            resume: Go on with the training in the folder, which no other program may do at the same time.

        Raises:
            ArgumentError: The folder holds no training, one with another algorithm, or one that is running.
        """
        settings = given or kind()
        if resume:
            self.claim()
            kept = self.settings()
            if not isinstance(kept, kind):
                what = f"{self.path} holds a training with {kept.algo}"
                raise ArgumentError(what, "resume it with irsim train --resume")
            settings = kept
        if steps is not None:
            settings = settings.model_copy(update={"steps": steps})
            if resume:
                self.keep(settings)
        return settings

    def has_rounds(self) -> bool:
        """Whether a round was finished."""
        return self._progress.is_file()

    def rounds(self) -> list[dict[str, Any]]:
        """Facts of each finished round."""
        if not self.has_rounds():
            return []
        try:
            rounds = read_json_lines(self._progress)
        except ContentError as error:
            raise _damaged(self._progress, error.message) from None
        if not all(isinstance(one, dict) for one in rounds):
            raise _damaged(self._progress, "a line is not a mapping")
        return rounds

    def save(self, model: Any, facts: dict[str, Any], *, best: bool) -> None:
        """Keep the model after a round. A kill at any moment leaves the round finished, or not begun.

        Args:
            model: The model.
            facts: Facts of the round.
            best: Whether it is the best so far.
        """
        lines = [json.dumps(one) for one in [*self.rounds(), facts]]
        following = self._following(len(lines))
        for target in [following, self.best] if best else [following]:
            with replacing(target) as temporary, temporary.open("wb") as file:
                model.save(file)
        write_atomically(self._progress, "\n".join(lines) + "\n")
        os.replace(following, self.latest)

    def settle(self) -> Path:
        """The model of the last finished round; what a kill or a full disk has left of another one is deleted.

        Only for who has claimed the folder.
        """
        finished = self._following(len(self.rounds()))
        if finished.exists():
            os.replace(finished, self.latest)
        for left in (*self.path.glob("next-*.zip"), *self.path.glob(".*.zip")):
            left.unlink()
        return self.latest

    def _following(self, number: int) -> Path:
        return self.path / f"next-{number}.zip"


@contextmanager
def loading(file: Path) -> Iterator[None]:
    """Turn whatever a library raises about the file of a model into an error of the folder.

    Raises:
        ArgumentError: The file is missing or damaged.
    """
    try:
        yield
    except Exception as error:
        lines = str(error).splitlines()
        raise _damaged(file, clean(lines[0] if lines else type(error).__name__, 200)) from error


def _damaged(file: Path, problem: str) -> ArgumentError:
    return ArgumentError(f"{file} is damaged: {problem}", "begin another training in another folder")
