"""The functions behind ``irsim.run``, ``irsim.render`` and ``irsim.validate``, which CLI, Python and MCP share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.api.run_scenario import (
        default_time_limit,
        diff,
        fix,
        import_modules,
        read_scenario,
        render,
        run,
        snapshot,
        validate,
    )

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

__getattr__, __dir__ = lazy_names(__name__, dict.fromkeys(__all__, "irsim.api.run_scenario"))
