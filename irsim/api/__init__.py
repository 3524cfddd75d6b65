"""The functions behind ``irsim.run``, ``irsim.render`` and ``irsim.validate``, which CLI, Python and MCP share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.api.read_input import read_scenario
    from irsim.api.render_scenario import render
    from irsim.api.run_scenario import run
    from irsim.api.take_snapshot import snapshot
    from irsim.scenario.open import import_modules
    from irsim.simulation.time_limit import default_time_limit
    from irsim.validation.validate import diff, fix, validate

__all__ = [
    "default_time_limit",
    "diff",
    "fix",
    "import_modules",
    "read_scenario",
    "render",
    "run",
    "snapshot",
    "validate",
]

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "default_time_limit": "irsim.simulation.time_limit",
        "diff": "irsim.validation.validate",
        "fix": "irsim.validation.validate",
        "import_modules": "irsim.scenario.open",
        "read_scenario": "irsim.api.read_input",
        "render": "irsim.api.render_scenario",
        "run": "irsim.api.run_scenario",
        "snapshot": "irsim.api.take_snapshot",
        "validate": "irsim.validation.validate",
    },
)
