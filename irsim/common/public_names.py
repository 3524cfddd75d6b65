"""Which module has each public name of ``irsim``."""

from __future__ import annotations

__all__ = ["PUBLIC_HOMES"]

PUBLIC_HOMES = {
    "Batch": "irsim.env.batch",
    "Env": "irsim.env",
    "EnvBase": "irsim.env",
    "EnvBase3D": "irsim.env",
    "IrsimError": "irsim.diagnostics.errors",
    "NotSimulatedError": "irsim.diagnostics.errors",
    "PlacementError": "irsim.diagnostics.errors",
    "Policy": "irsim.policies",
    "ScenarioError": "irsim.diagnostics.errors",
    "ScenarioNotFoundError": "irsim.diagnostics.errors",
    "batch": "irsim.env.batch",
    "benchmark": "irsim.benchmarks",
    "connect": "irsim.bridges.connect",
    "diff": "irsim.api",
    "diff_runs": "irsim.runs.comparison",
    "export_run": "irsim.bridges.export.export",
    "fix": "irsim.api",
    "make": "irsim.env",
    "open_policy": "irsim.policies",
    "register_behavior": "irsim.objects.extensions.registration",
    "render": "irsim.api",
    "replay": "irsim.runs.replay.export",
    "run": "irsim.api",
    "validate": "irsim.api",
}
"""Name -> the module that it is imported from when it is first used."""
