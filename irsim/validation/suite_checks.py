"""Checks of the scenarios of a suite, under each of its policies: what ``irsim.validate`` says of each as a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from irsim.benchmarks.suite import Suite
from irsim.benchmarks.suite_scenarios import expand, of_suite, placed, under_each_policy
from irsim.diagnostics.diagnostic import Diagnostic
from irsim.episodes.suitability import UNSUITED, unsuited
from irsim.scenario.behavior_override import AS_WRITTEN, behavior_text
from irsim.scenario.read import read
from irsim.validation.feasibility.check import feasibility_findings

__all__ = ["suite_warnings"]

_BROKEN_BY_NOISE = frozenset({"exact-symmetry"})
"""Codes of warnings that do not matter where each seed moves the starts a little."""


_OF_BEHAVIORS = frozenset({"exact-symmetry", "no-behavior", UNSUITED})
"""Codes of what depends on the behavior of robots, which the policies of a suite replace."""


def suite_warnings(suite: Suite, file: Path) -> list[Diagnostic]:
    """The warnings about the scenarios of a suite, one for each family and kind, with their places in its file.

    Each scenario is read under one protocol, with the behaviors that the suite compares in place of the robots' own; it
    is checked once whether its goals can be reached.

    Args:
        suite: The suite.
        file: Where it was read from.
    """
    warnings: dict[tuple[Any, ...], Diagnostic] = {}
    moved = any(one.position or one.heading for one in suite.perturb)
    for one in expand(suite, file):
        if one.protocol != suite.protocols[0]:
            continue
        written = _warnings(read(one.document(), strict=True, feasibility=feasibility_findings).diagnostics)
        known = {(item.code, item.path) for item in written}
        told = [(item, "") for item in written if AS_WRITTEN in suite.policies.values()]
        for name, data in under_each_policy(one, suite):
            for item in _warnings(read(one.document(data), strict=True).diagnostics):
                told.append((item, "" if (item.code, item.path) in known else f" under the policy {name!r}"))
        told += [(item, "") for item in written if item.code not in _OF_BEHAVIORS]
        scenario = read(one.document(), strict=True).scenario
        if scenario is not None:
            texts = [behavior_text(policy) for policy in suite.policies.values()]
            told += [(item, "") for text in texts for item in unsuited(text, scenario)]
        for item, under in told:
            if not (moved and item.code in _BROKEN_BY_NOISE):
                shown = of_suite(item, one, suite)
                shown = replace(shown, message=shown.message.replace(":", f"{under}:", 1))
                warnings.setdefault((one.family, item.code, item.path), shown)
    return placed(list(warnings.values()), suite, file)


def _warnings(items: Sequence[Diagnostic]) -> list[Diagnostic]:
    return [item for item in items if item.severity == "warning"]
