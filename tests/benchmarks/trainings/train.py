"""Trains a policy once more: ``python -m tests.benchmarks.trainings.train NAME SEED FOLDER`` for a name of ``RECIPES``.

FOLDER keeps the training; a training that was interrupted goes on. The weights of its best round by the validation
seeds of the task are kept in ``weights``. Needs the extra ``learn``.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
from pathlib import Path

__all__ = ["RECIPES", "SEEDS", "WEIGHTS", "commands", "weights_of"]

SEEDS = range(5)
WEIGHTS = Path(__file__).with_name("weights")
_PPO = "--steps 9e6 --set slots=448 --set batch=4096 --set epochs=3 --set round_updates=24"
_SARL = (
    "--algo sarl --steps 60e3 --set headings=7 --set demonstrations=400 --set demonstration_epochs=15 --set batch=300 "
    "--set explore=0.2 --set explore_end=0.05"
)
RECIPES = {"multi_robot": _PPO, "multi_robot_freeze": _PPO, "sarl_multi_robot": _SARL}
"""Name of a task -> the other words of ``irsim train``; no training is stopped before its last step."""


def weights_of(name: str, seed: int) -> Path:
    """The file of a training's weights."""
    return WEIGHTS / f"{name}-{seed}.npz"


def commands(name: str, seed: int, folder: Path) -> list[str]:
    """The commands that train, and that write the weights.

    Args:
        name: Name of a recipe.
        seed: Seed of the first weights, of exploration and of the order of samples.
        folder: Where the training is kept.
    """
    where = shlex.quote(str(folder))
    begin = f"irsim train {name} -o {where} --seed {seed} {RECIPES[name]}"
    train = f"irsim train --resume -o {where}" if folder.exists() else begin
    return [train, f"irsim export-policy {where} -o {shlex.quote(str(folder / 'policy.npz'))} --license MIT"]


def main(name: str, seed: str, folder: str) -> None:
    """Train, and keep the weights."""
    for command in commands(name, int(seed), Path(folder)):
        print(command, flush=True)
        subprocess.run(shlex.split(command), check=True)
    WEIGHTS.mkdir(exist_ok=True)
    target = weights_of(name, int(seed))
    target.write_bytes((Path(folder) / "policy.npz").read_bytes())
    print(f"wrote {target}")


if __name__ == "__main__":
    main(*sys.argv[1:])
