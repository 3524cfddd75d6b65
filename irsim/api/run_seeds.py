"""Several episodes of one scenario: ``irsim run --seeds`` and the tool ``run_episode`` with ``seeds``."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from irsim.api.read_input import in_suite
from irsim.api.run_scenario import run
from irsim.benchmarks.seeds import seeds_from
from irsim.common.text import plural
from irsim.diagnostics.errors import PlacementError
from irsim.episodes.episode import Progress
from irsim.results.benchmark import seeds_of
from irsim.results.findings import Finding
from irsim.results.run import RunResult, RunsResult
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.open import document_of
from irsim.scenario.read import read
from irsim.validation.feasibility.check import feasibility_findings
from irsim.validation.validate import warn_of_collisions

__all__ = ["failed_seeds", "run_seeds", "seeds_summary"]

_MAX_LISTED = 10
"""Number of seeds that the summary lists of each kind of failure."""


def run_seeds(
    path: str | Path | None = None,
    *,
    text: str | None = None,
    seeds: int | str | Sequence[int],
    wall_s: float | None = None,
    strict: bool = False,
    limits: Limits | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> RunsResult:
    """Simulate an episode for each seed; only one if every seed gives the same.

    Args:
        path: Scenario file, or ``SUITE/SCENARIO``.
        text: Text of the scenario, instead of ``path``.
        seeds: Their number, or the seeds, such as ``[1, 4]``, ``0-19`` or ``1,4``.
        wall_s: Computing time [s] in which no further episode begins that would not end in it.
        strict: Refuse what IR-SIM would ignore.
        limits: Limits of the loader and of each run.
        progress: Callback ``(episodes_done, episodes_total)``.
        **options: Further arguments of :func:`irsim.run`.

    Raises:
        InputError: The seeds are not valid.
        PlacementError: No seed leaves room for all objects.
        Others: as of :func:`irsim.run`.
    """
    chosen, begin, longest = seeds_from(seeds), time.monotonic(), 0.0
    episodes, crowded, same = list[RunResult](), list[int](), False
    last: PlacementError | None = None
    for number, seed in enumerate(chosen):
        started = time.monotonic()
        if wall_s is not None and number and started - begin + longest > wall_s:
            break
        try:
            episodes.append(run(path, text=text, seed=seed, strict=strict, limits=limits, **options))
        except PlacementError as error:
            last = error
            crowded.append(seed)
        longest = max(longest, time.monotonic() - started)
        same = bool(episodes) and not episodes[-1].random and episodes[-1].policy is None
        if progress is not None:
            progress(number + 1, number + 1 if same else len(chosen))
        if same:
            break
    if not episodes and last is not None:
        raise last
    left, failed = [] if same else chosen[len(episodes) + len(crowded) :], failed_seeds(episodes)
    return RunsResult(
        scenario=episodes[0].scenario,
        summary=seeds_summary(episodes, failed, crowded, left, same),
        failed=failed,
        crowded=crowded,
        not_run=left,
        same=same,
        episodes=episodes,
        warnings=_findings(path, text, strict, limits, episodes),
        version=episodes[0].version,
    )


def failed_seeds(episodes: Sequence[RunResult]) -> dict[str, list[int]]:
    """Seeds by outcome, of episodes that did not succeed."""
    failed: dict[str, list[int]] = {}
    for one in episodes:
        if one.outcome != "success":
            failed.setdefault(one.outcome, []).append(one.seed)
    return failed


def seeds_summary(
    episodes: Sequence[RunResult],
    failed: dict[str, list[int]],
    crowded: Sequence[int],
    left: Sequence[int] = (),
    same: bool = False,
) -> str:
    """How many episodes succeeded, and which seeds failed.

    Args:
        episodes: The episodes.
        failed: Seeds of episodes that did not succeed, by outcome.
        crowded: Seeds that leave no room for an object.
        left: Seeds for which there was no time.
        same: Whether one episode stands for all seeds.
    """
    good = len(episodes) - sum(map(len, failed.values()))
    if same:
        return f"{episodes[0].outcome}; nothing is random, so every seed gives this run (perturb varies its start)"
    parts = [f"{good} of {plural(len(episodes), 'episode')} succeeded"]
    parts += [f"failed: {seeds_of(failed, _MAX_LISTED)}"] if failed else []
    parts += [f"no room for an object: {seeds_of({'seeds': list(crowded)}, _MAX_LISTED)}"] if crowded else []
    parts += [f"time was up before {plural(len(left), 'more seed')}"] if left else []
    return "; ".join(parts)


def _findings(
    path: str | Path | None, text: str | None, strict: bool, limits: Limits | None, episodes: Sequence[RunResult]
) -> list[Finding]:
    """Findings of a check of the scenario; hints of collisions that happened in an episode become warnings."""
    first = episodes[0]
    if first.policy or first.behavior or in_suite(path) is not None:
        return first.warnings  # which consider what drives the robots
    most = limits or DEFAULT_LIMITS
    reading = read(document_of(path, text, limits), strict=strict, limits=most, feasibility=feasibility_findings)
    if reading.scenario is None:
        return first.warnings
    findings = [Finding.of(item) for item in reading.diagnostics]
    hit = {robot.name for one in episodes for robot in one.robots if robot.collision_count}
    warn_of_collisions(findings, reading.scenario, hit)
    return findings
