"""The method of an environment that loads a module of user behaviors."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

from irsim.env.state import EnvState
from irsim.objects.extensions.behaviors import attach_python_behaviors

__all__ = ["load_behavior"]


def load_behavior(env: EnvState, behaviors: str = "behavior_methods") -> None:
    """Import a module that registers behaviors, and construct behaviors that are classes again.

    Python executes a module once per process, however often it is loaded. If the import fails, an error is logged.

    Args:
        behaviors: Name of a module beside the running script, or anywhere on the path of Python.
    """
    folder = str(Path(sys.argv[0]).resolve().parent) if sys.argv and sys.argv[0] else str(Path.cwd())
    if folder not in sys.path:
        sys.path.append(folder)
    try:
        importlib.import_module(behaviors)
    except ImportError as error:
        env.logger.error(f"module {behaviors!r} could not be loaded: {error}")
        return
    attach_python_behaviors(env._simulation, anew=True)
