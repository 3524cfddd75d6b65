"""Findings that do not hold where a policy drives every robot instead of its own behavior."""

from __future__ import annotations

from collections.abc import Sequence

from irsim.diagnostics.diagnostic import format_path
from irsim.results.findings import Finding
from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["findings_under_policy"]


def findings_under_policy(findings: Sequence[Finding], scenario: ResolvedScenario) -> list[Finding]:
    """Leave out ``no-behavior`` of robots that can move, because the policy moves them.

    Args:
        findings: Findings about the scenario as written.
        scenario: The scenario.
    """
    driven = {format_path(record.path) for record in scenario.robots() if record.kinematics is not None}
    return [finding for finding in findings if not (finding.code == "no-behavior" and finding.path in driven)]
