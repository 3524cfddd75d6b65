"""These tests need torch, which only `nox -s learn` installs."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from irsim.learning.training.run_folder import RunFolder

collect_ignore_glob = [] if find_spec("torch") and find_spec("stable_baselines3") else ["test_*.py"]


class Killed(Exception):
    """Ends a training."""


def assert_resumed_as_whole(
    train: Callable[..., Any], weights: Callable[[Path], Any], folder: Path, *given: Any
) -> Any:
    """Train once as a whole and once with an end after the second round; returns the facts of the rounds.

    Args:
        train: Trains ``given`` in a folder, or goes on in it.
        weights: Reads the weights of ``latest.zip``.
        folder: Place of both trainings.
        given: The task and the settings.
    """

    def kill(done: Any) -> None:
        if done.number == 2:
            raise Killed

    task, settings = given
    train(task, folder / "whole", settings)
    with pytest.raises(Killed):
        train(task, folder / "killed", settings, on_round=kill)
    train("", folder / "killed", resume=True)
    whole = results(folder / "whole")
    assert whole == results(folder / "killed")
    assert_equal_weights(*(weights(folder / name / "latest.zip") for name in ("whole", "killed")))
    return whole


def assert_equal_weights(one: dict[str, Any], other: dict[str, Any]) -> None:
    assert all((one[key] == other[key]).all() for key in one)


def results(folder: Path) -> list[dict[str, Any]]:
    """Facts of the rounds of a training, without wall-clock times."""
    return [{key: value for key, value in one.items() if key != "seconds"} for one in RunFolder(folder).rounds()]
