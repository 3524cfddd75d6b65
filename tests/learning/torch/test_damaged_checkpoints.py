"""Damaged models of trainings: a training goes on from the file, or says that it is damaged."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from irsim.learning.training.export import export_policy
from tests.fuzz.damaged.kind import Kind
from tests.fuzz.damaged.test_damaged import try_ways
from tests.learning.torch.test_full_disk import ALGORITHMS

pytestmark = pytest.mark.learn
_WAYS = 40
"""Ways of each kind; there is no torch at night."""


def _model(algorithm: str, name: str) -> Callable[[Path], Path]:
    """A model of a training of one round, after which none is left."""
    run, task, settings, _ = ALGORITHMS[algorithm]

    def make(folder: Path) -> Path:
        run(task, folder / "run", settings.model_copy(update={"steps": 1}), max_time=0)
        return folder / "run" / name

    return make


def _resume(algorithm: str) -> Callable[[Path, random.Random], Any]:
    return lambda file, draw: ALGORITHMS[algorithm][0]("", file.parent, resume=True, max_time=0)


def _export(file: Path, draw: random.Random) -> None:
    export_policy(file.parent, file.parent.with_name("policy.npz"))


KINDS: Mapping[str, Kind] = {
    **{f"{name}-latest": Kind(_model(name, "latest.zip"), _resume(name)) for name in ALGORITHMS},
    **{f"{name}-best": Kind(_model(name, "best.zip"), _export, share=4) for name in ALGORITHMS},
}


@pytest.mark.parametrize("name", KINDS)
def test_damaged_models(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    try_ways(name, KINDS[name], tmp_path, range(0, _WAYS, KINDS[name].share))
