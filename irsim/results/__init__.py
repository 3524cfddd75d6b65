"""Typed results of every command: what the CLI prints and ``--json`` dumps."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.results.base import Result
    from irsim.results.benchmark import BenchmarkResult, BenchmarkRow, EpisodeRow, Estimate, Proportion
    from irsim.results.episode import EventRecord, Left, RobotResult
    from irsim.results.findings import Edit, Finding
    from irsim.results.picture import MovingPose, RenderResult, RobotPlan, RobotPose, SnapshotResult
    from irsim.results.run import HorizonSource, ReplayResult, RunResult, RunsResult, RunTable
    from irsim.results.validation import (
        CommentChange,
        DryRun,
        Fix,
        KeyChange,
        ScenarioDiff,
        Stuck,
        ValidationReport,
        WorldChange,
    )

__all__ = [
    "BenchmarkResult",
    "BenchmarkRow",
    "CommentChange",
    "DryRun",
    "Edit",
    "EpisodeRow",
    "Estimate",
    "EventRecord",
    "Finding",
    "Fix",
    "HorizonSource",
    "KeyChange",
    "Left",
    "MovingPose",
    "Proportion",
    "RenderResult",
    "ReplayResult",
    "Result",
    "RobotPlan",
    "RobotPose",
    "RobotResult",
    "RunResult",
    "RunTable",
    "RunsResult",
    "ScenarioDiff",
    "SnapshotResult",
    "Stuck",
    "ValidationReport",
    "WorldChange",
]

_NAMES = {
    "base": ["Result"],
    "benchmark": ["BenchmarkResult", "BenchmarkRow", "EpisodeRow", "Estimate", "Proportion"],
    "diff": ["CommentChange", "KeyChange", "ScenarioDiff", "WorldChange"],
    "episode": ["EventRecord", "Left", "RobotResult"],
    "findings": ["Edit", "Finding"],
    "picture": ["MovingPose", "RenderResult", "RobotPlan", "RobotPose", "SnapshotResult"],
    "run": ["HorizonSource", "ReplayResult", "RunResult", "RunTable", "RunsResult"],
    "validation": ["DryRun", "Fix", "Stuck", "ValidationReport"],
}
"""Public names of each module."""

__getattr__, __dir__ = lazy_names(
    __name__, {name: f"{__name__}.{module}" for module, names in _NAMES.items() for name in names}, [*_NAMES, "labels"]
)
