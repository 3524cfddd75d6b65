"""What the numbers of a benchmark take for granted: when contacts count, what robots can do, what behaviors know."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from irsim.common.text import listed
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

__all__ = ["assumptions_of"]

_NAMED = 3
"""Number of scenarios that a sentence names."""


def assumptions_of(scenarios: Mapping[str, ResolvedScenario]) -> list[str]:
    """Say what a reader must know before trusting the numbers, each in a few words.

    Args:
        scenarios: The scenarios of the benchmark, by name.
    """
    told = [(name, (_contacts(scenario), _limits(scenario))) for name, scenario in scenarios.items()]
    found = [_joined((name, facts[column]) for name, facts in told) for column in range(2)]
    return [*found, "behaviors know the poses and velocities of all objects exactly"] if told else []


def _joined(facts: Iterable[tuple[str, str]]) -> str:
    """The fact that all scenarios share; otherwise every fact with the scenarios that it holds for."""
    names: dict[str, list[str]] = {}
    for name, fact in facts:
        names.setdefault(fact, []).append(name)
    if len(names) == 1:
        return next(iter(names))
    return ", ".join(f"in {listed(found, _NAMED)} {fact}" for fact, found in names.items())


def _contacts(scenario: ResolvedScenario) -> str:
    if scenario.world.contacts == "swept":
        return "contacts within steps count, too"
    return f"contacts count at the ends of steps of {scenario.world.step_time:g} s only"


def _limits(scenario: ResolvedScenario) -> str:
    limited = [_is_limited(record) for record in scenario.objects if record.role == "robot" and not record.static]
    if all(limited):
        return "accelerations are limited"
    if any(limited):
        return "accelerations of some robots are limited"
    return "robots change their speed at once (no acce)"


def _is_limited(record: ObjectRecord) -> bool:
    return any(math.isfinite(limit) for limit in record.acce)
