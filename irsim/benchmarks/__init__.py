"""Comparison of behaviors: scenarios x behaviors x seeds, simulated on all cores and summarised as tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.benchmarks.comparison import benchmark
    from irsim.benchmarks.log import logged
    from irsim.benchmarks.preparation import DEFAULT_SEEDS
    from irsim.diagnostics.errors import BenchmarkError
    from irsim.scenario.behavior_override import AS_WRITTEN

__all__ = ["AS_WRITTEN", "DEFAULT_SEEDS", "BenchmarkError", "benchmark", "logged"]

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "AS_WRITTEN": "irsim.scenario.behavior_override",
        "BenchmarkError": "irsim.diagnostics.errors",
        "DEFAULT_SEEDS": "irsim.benchmarks.preparation",
        "benchmark": "irsim.benchmarks.comparison",
        "logged": "irsim.benchmarks.log",
    },
)
