"""Policies outside the scenes that their cards name: laws of the scenario, and a policy that is to drive its robots."""

from __future__ import annotations

from collections.abc import Iterator

from irsim.episodes.suitability import law_findings, unsuited
from irsim.scenario.checks import Context
from irsim.scenario.messages.findings import Finding

__all__ = ["check"]


def check(context: Context, policy: str | None = None) -> Iterator[Finding]:
    """Report laws, or the policy that drives the robots in their place.

    Args:
        context: The scenario.
        policy: Name of the policy; None: the robots have their own behaviors.
    """
    path, _, _ = next(context.entries(), (("robot",), None, None))
    findings = law_findings(context.resolved) if policy is None else unsuited(policy, context.resolved, path)
    yield from (Finding(item) for item in findings)
