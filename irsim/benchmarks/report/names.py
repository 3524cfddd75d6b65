"""Names of scenarios and policies as a report shows them, and the rows in their order."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from irsim.results.benchmark import BenchmarkResult, BenchmarkRow
from irsim.results.labels import labels_of
from irsim.results.suite import SuiteResult

__all__ = ["families", "policy_labels", "series"]


def policy_labels(result: BenchmarkResult) -> dict[str, str]:
    """Behavior as the rows have it → name."""
    if isinstance(result, SuiteResult):
        return {text: name for name, text in result.policies.items()}
    return labels_of(result.behaviors)


def families(result: BenchmarkResult) -> Iterator[tuple[str, str, list[tuple[dict[str, Any], str]]]]:
    """Family, protocol, and (values, name) of its scenarios, of each family of a suite with several scenarios."""
    if not isinstance(result, SuiteResult):
        return
    keys = list(dict.fromkeys((fact.family, fact.protocol) for fact in result.facts))
    for family, protocol in keys:
        own = [(f.values, f.name) for f in result.facts if (f.family, f.protocol) == (family, protocol)]
        if len(own) > 1:
            yield family, protocol, own


def series(result: BenchmarkResult, names: list[str], behavior: str) -> list[BenchmarkRow]:
    """The rows of a policy on some scenarios, in the order of the names."""
    found = {row.scenario: row for row in result.rows if row.behavior == behavior}
    return [found[name] for name in names if name in found]
