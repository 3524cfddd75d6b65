"""The typed result of a suite: that of a benchmark, and what the suite says about its scenarios."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from irsim.results.base import Result
from irsim.results.benchmark import BenchmarkResult

__all__ = ["SuiteResult", "SuiteScenarioFacts"]


class SuiteScenarioFacts(Result):
    """What a scenario of a suite is."""

    name: str
    """Its name in the rows."""
    family: str
    """Its name in the suite file."""
    protocol: str
    """What robots do that have arrived: ``freeze``, ``yield``, or ``as-written``."""
    values: dict[str, Any]
    """The values that vary in its family."""


class SuiteResult(BenchmarkResult):
    """What ``irsim benchmark SUITE`` found."""

    suite: str
    """Name of the suite."""
    suite_version: int
    """Version of the suite."""
    title: str
    """What it is about."""
    about: str = ""
    """What it measures, and how to read its results."""
    sources: list[str] = Field(default_factory=list)
    """Papers and pages that the suite follows."""
    steps: int | None = None
    """Horizon in steps; scenarios may have their own."""
    until: Literal["done", "first_collision"] | None = None
    """When an episode ends before its horizon: when every robot has arrived or stopped (``done``), or already when one
    collides."""
    suite_hash: str
    """Hash of the suite, whatever part of it is run."""
    hash: str
    """Hash of everything that decides the numbers of this run: scenarios, policies, seeds and version."""
    policies: dict[str, str]
    """Name in the suite → behavior as the rows have it."""
    facts: list[SuiteScenarioFacts]
    """The scenarios in order."""
