"""Before the first step: find a seed with room for every object, and say which findings hold for this run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

from irsim.common.text import listed
from irsim.diagnostics.diagnostic import Diagnostic, format_path
from irsim.diagnostics.errors import PlacementError
from irsim.results.benchmark import CROWDED
from irsim.results.findings import Finding
from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = [
    "MAX_TRIES",
    "UNOPENED",
    "crowded_message",
    "findings_under_policy",
    "first_with_room",
    "unopened_bridges",
    "unopened_findings",
]

T = TypeVar("T")
MAX_TRIES = 20
"""Number of seeds that are tried before a scenario counts as too crowded."""
UNOPENED = "bridges-not-opened"
"""Code of the warning about bridges that what simulates does not open."""
_MAX_NAMED = 10
"""Number of seeds that a message names."""


def first_with_room(make: Callable[[int], T], seeds: Iterable[int]) -> tuple[T, list[int]]:
    """Make something with the first seed that leaves room for every object.

    Args:
        make: Function of a seed.
        seeds: Seeds to try, at least one.

    Returns:
        The object that was made, and the seeds before it that leave no room.

    Raises:
        PlacementError: None of the seeds leaves room; the error of the first one is raised.
    """
    first: PlacementError | None = None
    crowded: list[int] = []
    for seed in seeds:
        try:
            return make(seed), crowded
        except PlacementError as error:
            first = first or error
            crowded.append(seed)
    assert first is not None
    raise first


def crowded_message(crowded: Sequence[int]) -> str | None:
    """Name the seeds that had no room; None if every seed had."""
    if not crowded:
        return None
    many = len(crowded) > 1
    return f"seed{'s' * many} {listed([str(seed) for seed in crowded], _MAX_NAMED)} had no room ({CROWDED})"


def findings_under_policy(findings: Sequence[Finding], scenario: ResolvedScenario) -> list[Finding]:
    """Leave out ``no-behavior`` of robots that can move, because the policy moves them.

    Args:
        findings: Findings about the scenario as written.
        scenario: The scenario.
    """
    driven = {format_path(record.path) for record in scenario.robots() if record.kinematics is not None}
    return [finding for finding in findings if not (finding.code == "no-behavior" and finding.path in driven)]


def unopened_bridges(scenario: ResolvedScenario, what: str) -> list[Diagnostic]:
    """A warning for a scenario with bridges; empty without bridges.

    Args:
        scenario: The scenario.
        what: The work that does not open them, such as ``a benchmark``.
    """
    names = [str(getattr(one, "name", "bridge")) for one in scenario.bridges]
    if not names:
        return []
    message = f"{what} simulates without the bridges of the scenario ({', '.join(dict.fromkeys(names))})"
    fix = "irsim run, or irsim.connect in Python, opens them"
    return [Diagnostic(UNOPENED, "warning", ("bridges",), message, fix=fix)]


def unopened_findings(scenario: ResolvedScenario, what: str) -> list[Finding]:
    """The warning of :func:`unopened_bridges`, as results have it."""
    return [Finding.of(item) for item in unopened_bridges(scenario, what)]
