"""Lets PyInstaller find the old module paths: it reads imports from files, and the old paths have no files."""

from __future__ import annotations

from pathlib import Path

__all__ = ["hook_folders"]


def hook_folders() -> list[str]:
    """Folders with hooks; PyInstaller asks through the entry point ``pyinstaller40``."""
    return [str(Path(__file__).parent)]
