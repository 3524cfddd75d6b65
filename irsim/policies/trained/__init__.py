"""Policies that were trained with irsim and ship with it, by their names."""

from __future__ import annotations

from pathlib import Path

__all__ = ["COMMON_NAMES", "trained_policies", "trained_policy"]

COMMON_NAMES = {"ppo": "multi_robot", "ppo_freeze": "multi_robot_freeze"}
"""Other name of a policy, which people and suites use → its name."""
_FOLDER = Path(__file__).parent


def trained_policies() -> list[str]:
    """Their names, sorted; the model card of each lies beside its file."""
    return sorted(path.stem for path in _FOLDER.glob("*.npz"))


def trained_policy(name: str) -> Path:
    """The file of a policy."""
    return _FOLDER / f"{name}.npz"
