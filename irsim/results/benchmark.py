"""The typed result of ``irsim.benchmark``: episodes, and what they come to by scenario and behavior."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irsim.results.base import Result
from irsim.results.findings import Finding

__all__ = ["BenchmarkResult", "BenchmarkRow", "EpisodeRow", "Estimate", "Proportion"]


class Proportion(Result):
    """A share of episodes."""

    count: int
    """In how many."""
    n: int
    """Of how many."""
    rate: float
    """Share."""
    low: float | None
    """Lower end of the 95 % interval (Wilson); None where nothing is random: it cannot come out differently."""
    high: float | None
    """Upper end of it."""


class Estimate(Result):
    """A number over episodes. Episodes in which it is undefined are left out."""

    n: int
    """Episodes it is defined in."""
    mean: float | None = None
    """Mean; None without any."""
    std: float | None = None
    """Standard deviation of the sample; None for fewer than two."""
    low: float | None = None
    """Lower end of the 95 % interval of the mean: bootstrap (10,000 resamples, always the same draws); of metrics that
    are 0 or 1 Wilson, None where nothing is random; of paired shares see ``paired``."""
    high: float | None = None
    """Upper end of it."""


class BenchmarkRow(Result):
    """One scenario under one behavior, over all seeds."""

    scenario: str
    """The file; ``(all)`` for all files together, where each has as many episodes, and several or the files are ten."""
    behavior: str
    """What the robots followed: a behavior, or ``as-written``."""
    episodes: int
    """How many."""
    success: Proportion
    """Every robot reached its goal without a collision before."""
    collision: Proportion
    """A robot was stopped by a collision, or arrived after one."""
    timeout: Proportion
    """Neither, at the horizon."""
    metrics: dict[str, Estimate]
    """Metrics of the episodes by key: ``time_to_goal`` [s], ``path_length`` [m], ``velocity_avg`` [m/s], …"""
    paired: dict[str, Estimate] = Field(default_factory=dict)
    """Differences to the first behavior, episode by episode with equal scenario and seed; ``success``, ``collision``
    and ``timeout`` among them. The intervals of such shares are Newcombe's for pairs, which are right also where all
    pairs agree."""
    failed: dict[str, list[int]] = Field(default_factory=dict)
    """Seeds that ended in ``collision`` and in ``timeout``; empty for ``(all)``."""
    failures: dict[str, int] = Field(default_factory=dict)
    """In how many episodes a robot failed in which way, the ten most frequent: ``'car': timeout``; empty for
    ``(all)``."""


class EpisodeRow(Result):
    """One episode of a benchmark."""

    scenario: str
    """The file."""
    behavior: str
    """What the robots followed."""
    seed: int
    """Its seed."""
    outcome: Literal["success", "collision", "timeout"]
    """As in :class:`RunResult`."""
    steps: int
    """Executed steps."""
    sim_time: float
    """Simulated time [s]."""
    time_limit: float
    """Horizon [s]."""
    unreachable: int
    """Robots for which no way to their goal was found."""
    failures: dict[str, str]
    """What became of the first ten robots without success, by name: ``timeout``, or ``collision with 'crate'``."""
    metrics: dict[str, float | None]
    """Metrics of the episode by key; None where undefined."""


class BenchmarkResult(Result):
    """What ``irsim benchmark`` found."""

    scenarios: list[str]
    """The files."""
    behaviors: list[str]
    """The behaviors; differences are to the first."""
    seeds: list[int]
    """The seeds, the same for all."""
    step_time: dict[str, float]
    """Period of each scenario [s]: metrics are sampled at every step."""
    random: dict[str, list[str]]
    """What the seed decides in each scenario; one where it decides nothing is run with the first seed only."""
    rows: list[BenchmarkRow]
    """By scenario, then behavior; then all scenarios together, if there are several with as many episodes each."""
    episodes: list[EpisodeRow]
    """Every episode."""
    notes: list[str]
    """What to know before reading on."""
    warnings: dict[str, list[Finding]]
    """What is odd about the scenarios."""
    version: str
    """Version of irsim."""
    reproduce: str
    """Command that gives the same again."""
