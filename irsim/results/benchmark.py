"""The typed result of ``irsim.benchmark``: episodes, their summary by scenario and behavior, and the suite."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

from pydantic import Field

from irsim.common.lazy import call_home
from irsim.common.notebook import facts, section, table, text_table
from irsim.common.text import clean, listed
from irsim.results.base import Result
from irsim.results.findings import Finding

__all__ = [
    "CROWDED",
    "LOST",
    "BenchmarkResult",
    "BenchmarkRow",
    "EpisodeRow",
    "Estimate",
    "PolicyPair",
    "PolicyRank",
    "Proportion",
    "SuiteResult",
    "SuiteScenarioFacts",
    "ending",
    "seeds_of",
]


class Proportion(Result):
    """A share of episodes."""

    count: int
    """Number of episodes in which it happened."""
    n: int
    """Number of all episodes."""
    rate: float
    """``count / n``."""
    low: float | None
    """Lower end of the 95 % interval (Wilson); None where nothing is random, because the share is exact there. Of rows
    over several scenarios see ``BenchmarkRow.scenario``."""
    high: float | None
    """Upper end of the interval."""


class Estimate(Result):
    """A metric over episodes. Episodes in which it is undefined are left out."""

    n: int
    """Number of episodes in which it is defined."""
    mean: float | None = None
    """Mean; None without such episodes."""
    std: float | None = None
    """Sample standard deviation; None for fewer than two episodes."""
    low: float | None = None
    """Lower end of the 95 % interval of the mean, by bootstrap (10,000 resamples, always the same draws); for metrics
    that are 0 or 1 by Wilson, and None where nothing is random; for differences of shares see ``paired``."""
    high: float | None = None
    """Upper end of the interval."""


class BenchmarkRow(Result):
    """One scenario under one behavior, over all seeds."""

    scenario: str
    """The file; ``(all)`` for all files together, if each has the same number of episodes, and that number is above
    one or there are at least ten files; ``(all TAG)`` for those with a tag of their suite. A suite with several
    protocols has ``(all)/freeze``, ``(all)/yield`` instead: each protocol is summarised on its own. Each episode
    counts once, so scenarios have equal weights unless some of their seeds had no room. Intervals of these rows are of
    a nested bootstrap (2,000 resamples of scenarios, and of seeds within each), of shares at least Wilson's and
    Newcombe's: they say what other scenarios of the same kind would give."""
    behavior: str
    """The robots' behavior, or ``as-written``."""
    episodes: int
    """Number of episodes, without the ``placement-crowded`` ones; the equal ones of ``BenchmarkResult.certain`` are one
    in each scenario."""
    success: Proportion
    """Every robot reached its goal without a collision before."""
    collision: Proportion
    """A robot was stopped by a collision, or arrived after one."""
    timeout: Proportion
    """Neither, when the time limit was reached."""
    metrics: dict[str, Estimate]
    """Metrics of the episodes by key: ``time_to_goal`` [s], ``path_length`` [m], ``velocity_avg`` [m/s], …"""
    paired: dict[str, Estimate] = Field(default_factory=dict)
    """Differences to the first behavior, paired by scenario and seed; ``success``, ``collision`` and ``timeout`` are
    among them. The intervals of these three are Newcombe's for paired shares, which hold even where all pairs
    agree."""
    zones: dict[str, dict[str, Estimate]] = Field(default_factory=dict)
    """Metrics of each zone of ``world.zones``, by its name: ``time_in_zone`` [s], ``zone_crossings``, and of a line
    ``left_to_right`` and ``right_to_left``; empty for ``(all)``."""
    roles: dict[str, dict[str, Estimate]] = Field(default_factory=dict)
    """Metrics of each role, where several policies share the robots, by its name or tag: see ``EpisodeRow.roles``. An
    episode counts once, whatever the number of its robots; empty for ``(all)``."""
    failed: dict[str, list[int]] = Field(default_factory=dict)
    """Seeds that ended in ``collision`` and in ``timeout``; empty for ``(all)``."""
    failures: dict[str, int] = Field(default_factory=dict)
    """Number of episodes by failing robot and kind of failure, the ten most frequent: ``'car': timeout``; empty for
    ``(all)``."""
    incidents: dict[str, int] = Field(default_factory=dict)
    """Number of episodes with what outcomes do not say: ``contacts_between_steps`` (a robot touched something within a
    step and at neither end of it, before it arrived), ``human_contacts`` (people touched each other), ``left`` (an
    object left the world), ``jumped`` (one jumped over its goal), ``seen`` (a robot was in the ``fov`` of another
    object), ``policy-lost`` (the policy could not go on); and ``placement-crowded``, the number of seeds without room,
    which are not among ``episodes``. Only those above 0."""
    incident_seeds: dict[str, list[int]] = Field(default_factory=dict)
    """Seeds of these episodes by the same names; empty for ``(all)``."""


class PolicyPair(Result):
    """Two policies in the same episodes, by success."""

    scenario: str
    """The row, as ``BenchmarkRow.scenario``."""
    behavior: str
    """One policy."""
    against: str
    """The other one."""
    difference: Estimate
    """Share of episodes that succeed under ``behavior`` minus that under ``against``, with its interval."""
    only_behavior: int
    """Number of episodes in which only ``behavior`` succeeds."""
    only_against: int
    """Number of episodes in which only ``against`` succeeds."""
    p: float | None
    """Exact two-sided p-value of McNemar's test; None over several scenarios, whose episodes are not independent. Of
    many pairs some are below 0.05 by chance: ``verdict.py --all-pairs`` corrects that (Holm)."""


class PolicyRank(Result):
    """The rank of a policy by success."""

    scenario: str
    """The row, as ``BenchmarkRow.scenario``."""
    behavior: str
    """The policy."""
    rank: float
    """Its rank, 1 for the greatest share of successes; of equals the mean of their places."""
    low: int
    """Its best rank by the 95 % intervals of ``pairs``: one more than the number of policies that are better."""
    high: int
    """Its worst rank that they allow."""


class EpisodeRow(Result):
    """One episode of a benchmark."""

    scenario: str
    """The file."""
    behavior: str
    """The robots' behavior, or ``as-written``."""
    seed: int
    """Its seed."""
    outcome: Literal["success", "collision", "timeout", "placement-crowded"]
    """As in :class:`RunResult`; ``placement-crowded``: the seed leaves no room for an object, so nothing was run."""
    steps: int
    """Number of executed steps."""
    sim_time: float
    """Simulated time [s]."""
    time_limit: float
    """Horizon [s]."""
    unreachable: int
    """Number of robots for which no path to their goal was found."""
    failures: dict[str, str]
    """How the first ten unsuccessful robots failed, by name: ``timeout``, or ``collision with 'crate'``."""
    human_contacts: int = 0
    """Number of contacts that began between two people: moving obstacles, or objects tagged ``pedestrian``."""
    left: list[str] = Field(default_factory=list)
    """The first ten moving objects whose position left the world."""
    jumped: list[str] = Field(default_factory=list)
    """The first ten objects that passed a goal within ``goal_threshold`` between two steps and did not arrive later."""
    lost: str | None = None
    """Why the policy could not go on, which ended the episode early; its robots then count as they were. None
    otherwise."""
    metrics: dict[str, float | None]
    """Metrics of the episode by key; None where undefined."""
    zones: dict[str, dict[str, float]] = Field(default_factory=dict)
    """Metrics of each zone of ``world.zones``, by its name: means over the robots."""
    roles: dict[str, dict[str, float | None]] = Field(default_factory=dict)
    """Metrics of each role, where several policies share the robots (``{name: mixed, …}``): ``robots`` (their number),
    ``success``, ``collision`` and ``timeout`` (shares of them), ``time_to_goal`` [s] and ``velocity_avg`` [m/s] (means
    over robots that arrived), ``restricted_time`` [s] and ``collision_count`` (means); None where undefined."""


class BenchmarkResult(Result):
    """The result of ``irsim benchmark``."""

    scenarios: list[str]
    """The files."""
    behaviors: list[str]
    """The policies; differences are to the first."""
    information: dict[str, str] = Field(default_factory=dict)
    """The information of each policy besides its own state and goal, as a class: ``outlines``, ``circles``,
    ``neighbors(k, r)`` (the k nearest circles within r), ``lidar``, ``map`` or ``blind``, with ``+intent`` for who has
    arrived or gives way by the same law. Only policies of one class compete with equal means; policies of which it is
    not known are left out."""
    digests: dict[str, str] = Field(default_factory=dict)
    """SHA-256 of the file of each policy that is one."""
    seeds: list[int]
    """The seeds, the same for all."""
    step_time: dict[str, float]
    """Period of each scenario [s]: metrics are sampled at every step."""
    perturb: list[str] = Field(default_factory=list)
    """Perturbations of starts, speeds and delays, as on the command line."""
    perturbed: dict[str, list[str]] = Field(default_factory=dict)
    """The changes that they make in each scenario, in words; empty without a perturbation."""
    unequal: dict[str, str] = Field(default_factory=dict)
    """Which limits of robots differ between the policies, in words, by scenario; empty if all are equal."""
    assumptions: list[str] = Field(default_factory=list)
    """Assumptions behind the numbers, in words: when contacts count, how fast robots change their speed, and what
    behaviors know."""
    random: dict[str, list[str]]
    """Parts that the seed decides in each scenario; a scenario without such parts runs with the first seed only."""
    certain: dict[str, list[str]] = Field(default_factory=dict)
    """Policies that no such part reaches, by scenario. If the episodes of all seeds are equal, too, they count as
    one episode in rows and pairs."""
    rows: list[BenchmarkRow]
    """By scenario, then behavior; then all scenarios together, if there are several with equal numbers of episodes, and
    each protocol of a suite on its own."""
    groups: dict[str, list[str]] = Field(default_factory=dict)
    """Scenarios of each tag of the suite, which have rows ``(all TAG)``."""
    pairs: list[PolicyPair] = Field(default_factory=list)
    """Every pair of policies in every row."""
    ranks: list[PolicyRank] = Field(default_factory=list)
    """Rank of each policy in every row; empty with one policy."""
    episodes: list[EpisodeRow]
    """Every episode."""
    incidents: list[str] = Field(default_factory=list)
    """Incidents besides outcomes, in words: contacts between people, objects that left the world or jumped over
    their goal, robots that were seen, seeds without room."""
    notes: list[str]
    """Remarks that matter for reading the numbers."""
    warnings: dict[str, list[Finding]]
    """Warnings about the scenarios."""
    version: str
    """Version of irsim."""
    engine: str = ""
    """Identity of the engine that ran all episodes, which changes with each source that decides a number; empty in
    results from before engines had one."""
    reproduce: str
    """Command that reproduces this result."""

    def to_pandas(self) -> Any:
        """A table of pandas with one row per episode, and the columns of ``results.parquet``.

        ``attrs["units"]`` of the table has the unit of each column.

        Raises:
            ExtraError: pandas is missing.
        """
        return call_home("irsim.benchmarks.report.table:result_frame", self)

    def __repr__(self) -> str:
        lines = [f"Benchmark of {len(self.seeds)} seeds, {len(self.episodes)} episodes", text_table(*self._table())]
        return "\n".join([*lines, f"reproduce: {clean(self.reproduce, 400)}"])

    __str__ = __repr__

    def _repr_html_(self) -> str:
        known = {"seeds": len(self.seeds), "episodes": len(self.episodes), "reproduce": self.reproduce}
        return section("Benchmark", table(*self._table()), facts(known))

    def _table(self) -> tuple[Sequence[str], list[Sequence[object]]]:
        """The columns and rows that show the result."""
        columns = ("scenario", "policy", "episodes", "success", "95 % interval", "collision", "timeout")
        rows: list[Sequence[object]] = [
            (
                row.scenario, row.behavior, row.episodes, _percent(row.success.rate),
                f"{_percent(row.success.low)} to {_percent(row.success.high)}" if row.success.low is not None else None,
                _percent(row.collision.rate), _percent(row.timeout.rate),
            )
            for row in self.rows
        ]  # fmt: skip
        return columns, rows


def _percent(share: float | None) -> str:
    return "" if share is None else f"{share:.0%}"


class SuiteScenarioFacts(Result):
    """Facts about a scenario of a suite."""

    name: str
    """Its name in the rows."""
    family: str
    """Its name in the suite file."""
    protocol: str
    """Behavior of robots that have arrived: ``freeze``, ``yield``, or ``as-written``."""
    values: dict[str, Any]
    """The values that vary in its family."""


class SuiteResult(BenchmarkResult):
    """The result of ``irsim benchmark SUITE``."""

    suite: str
    """Name of the suite."""
    suite_version: int
    """Version of the suite."""
    title: str
    """Its subject."""
    about: str = ""
    """The abilities that it measures, and how to read its results."""
    sources: list[str] = Field(default_factory=list)
    """Papers and pages that the suite follows."""
    steps: int | None = None
    """Horizon in steps; scenarios may have their own. None where it is in seconds."""
    seconds: float | None = None
    """Horizon in seconds."""
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


CROWDED = "placement-crowded"
"""Outcome of an episode of a benchmark whose seed leaves no room for an object."""

LOST = "policy-lost"
"""Name of what happens to an episode whose policy, in another process, cannot go on."""


def ending(outcome: str, lost: str | None) -> str:
    """The word for how a run ended: its outcome, but ``lost`` if time was left when something was lost."""
    return "lost" if lost is not None and outcome == "timeout" else outcome


def seeds_of(failed: dict[str, list[int]], most: int) -> str:
    """List the failed seeds: ``timeout: seeds 18, 23, 32; collision: seed 7``; empty if none failed.

    Args:
        failed: Seeds by outcome.
        most: Maximum number of seeds to list per outcome.
    """
    parts = []
    for outcome, seeds in failed.items():
        parts.append(f"{outcome}: seed{'s' * (len(seeds) > 1)} {listed([str(seed) for seed in seeds], most)}")
    return "; ".join(parts)
