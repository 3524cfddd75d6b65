"""irsim: a fast 2D robot-navigation simulator whose scenarios are YAML files.

Names are imported when first used, so ``import irsim`` costs next to nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from irsim._conflict import refuse_conflicts

refuse_conflicts()

if TYPE_CHECKING:
    from irsim.api import diff, fix, render, run, validate
    from irsim.batch import Batch, batch
    from irsim.benchmarks import benchmark
    from irsim.env import Env, EnvBase, EnvBase3D, make
    from irsim.errors import IrsimError, NotSimulatedError, PlacementError, ScenarioError, ScenarioNotFoundError
    from irsim.lib import register_behavior
    from irsim.replay.export import replay

    __version__: str

_HOMES = {
    "Batch": "irsim.batch",
    "Env": "irsim.env",
    "EnvBase": "irsim.env",
    "EnvBase3D": "irsim.env",
    "IrsimError": "irsim.errors",
    "NotSimulatedError": "irsim.errors",
    "PlacementError": "irsim.errors",
    "ScenarioError": "irsim.errors",
    "ScenarioNotFoundError": "irsim.errors",
    "batch": "irsim.batch",
    "benchmark": "irsim.benchmarks",
    "diff": "irsim.api",
    "fix": "irsim.api",
    "make": "irsim.env",
    "register_behavior": "irsim.lib",
    "render": "irsim.api",
    "replay": "irsim.replay.export",
    "run": "irsim.api",
    "validate": "irsim.api",
}

__all__ = [
    "Batch",
    "Env",
    "EnvBase",
    "EnvBase3D",
    "IrsimError",
    "NotSimulatedError",
    "PlacementError",
    "ScenarioError",
    "ScenarioNotFoundError",
    "__version__",
    "batch",
    "benchmark",
    "diff",
    "fix",
    "make",
    "register_behavior",
    "render",
    "replay",
    "run",
    "validate",
]


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name == "__version__":
        from importlib.metadata import version

        value: Any = version("irsim-mcp")
    elif name in _HOMES:
        value = getattr(import_module(_HOMES[name]), name)
    else:
        raise AttributeError(f"module 'irsim' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
