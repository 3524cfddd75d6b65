"""The tasks that ship with irsim."""

from __future__ import annotations

from pathlib import Path

__all__ = ["bundled_task", "bundled_tasks"]

_FOLDER = Path(__file__).with_name("bundled")


def bundled_tasks() -> list[str]:
    """Their names, sorted."""
    return sorted(path.stem for path in _FOLDER.glob("*.yaml"))


def bundled_task(name: str) -> Path:
    """The file of a task."""
    return _FOLDER / f"{name}.yaml"
