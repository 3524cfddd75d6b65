"""The bundled maps, by name."""

from __future__ import annotations

from pathlib import Path

__all__ = ["bundled_map", "bundled_names", "replacement_map"]

_FOLDER = Path(__file__).parent / "_data"
_STAND_INS = {f"hm3d_{number}.png": f"flat_{1 + (number - 1) % 2}.png" for number in range(1, 10)}
"""Indoor scans of IR-SIM that cannot be redistributed, and the bundled flats that replace them."""


def bundled_names() -> list[str]:
    """File names of the bundled maps, sorted, without the names that other maps replace."""
    return sorted(path.name for path in _FOLDER.glob("*.png"))


def replacement_map(name: str) -> str | None:
    """The bundled map that replaces a map that is not included; None for any other name."""
    return _STAND_INS.get(name)


def bundled_map(name: str) -> Path | None:
    """The file of a bundled map; None if no bundled map has that name."""
    path = _FOLDER / _STAND_INS.get(name, name)
    return path if path.parent == _FOLDER and path.name in bundled_names() else None
