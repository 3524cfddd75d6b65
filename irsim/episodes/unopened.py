"""Says that what runs a scenario does not open its bridges, which are opened by runs only."""

from __future__ import annotations

from irsim.diagnostics.diagnostic import Diagnostic
from irsim.results.findings import Finding
from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["CODE", "unopened_bridges", "unopened_findings"]

CODE = "bridges-not-opened"
"""Code of the warning."""


def unopened_bridges(scenario: ResolvedScenario, what: str) -> list[Diagnostic]:
    """A warning for a scenario with bridges; none for others.

    Args:
        scenario: The scenario.
        what: What does not open them, such as ``a benchmark``.
    """
    names = [str(getattr(one, "name", "bridge")) for one in scenario.bridges]
    if not names:
        return []
    message = f"{what} simulates without the bridges of the scenario ({', '.join(dict.fromkeys(names))})"
    fix = "irsim run, or irsim.connect in Python, opens them"
    return [Diagnostic(CODE, "warning", ("bridges",), message, fix=fix)]


def unopened_findings(scenario: ResolvedScenario, what: str) -> list[Finding]:
    """The same as results have it."""
    return [Finding.of(item) for item in unopened_bridges(scenario, what)]
