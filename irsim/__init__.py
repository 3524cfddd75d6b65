"""irsim: a fast 2D robot-navigation simulator whose scenarios are YAML files.

Names are imported when first used, so ``import irsim`` costs next to nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from irsim.common.installed import refuse_conflicts
from irsim.common.lazy import PUBLIC_HOMES, lazy_names
from irsim.compat.finder import install

refuse_conflicts()
install()

if TYPE_CHECKING:
    from irsim.api import diff, fix, render, run, validate
    from irsim.api.run_controller import episodes
    from irsim.benchmarks import benchmark
    from irsim.bridges.connect import connect
    from irsim.bridges.export.export import export_run
    from irsim.diagnostics.errors import (
        IrsimError,
        NotSimulatedError,
        PlacementError,
        ScenarioError,
        ScenarioNotFoundError,
    )
    from irsim.env import Env, EnvBase, EnvBase3D, make
    from irsim.env.batch import Batch, batch
    from irsim.objects.extensions.registration import register_behavior
    from irsim.policies import Policy, open_policy
    from irsim.runs.comparison import diff_runs
    from irsim.runs.replay.export import replay

    __version__: str

_PACKAGES = frozenset({"config", "env", "gui", "lib", "msg", "util", "version", "world"})
"""Packages of IR-SIM that are attributes of ``irsim`` whether a script has imported them or not."""

__all__ = [
    "Batch",
    "Env",
    "EnvBase",
    "EnvBase3D",
    "IrsimError",
    "NotSimulatedError",
    "PlacementError",
    "Policy",
    "ScenarioError",
    "ScenarioNotFoundError",
    "__version__",
    "batch",
    "benchmark",
    "connect",
    "diff",
    "diff_runs",
    "episodes",
    "export_run",
    "fix",
    "make",
    "open_policy",
    "register_behavior",
    "render",
    "replay",
    "run",
    "validate",
]


_get, _list = lazy_names(__name__, PUBLIC_HOMES, {*_PACKAGES, "learning"})


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from irsim.common.installed import version

        return version()
    return _get(name)


def __dir__() -> list[str]:
    return [*_list(), "__version__"]
