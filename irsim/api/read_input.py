"""Reads what commands take as a scenario: a file, a text, or a scenario of a suite (``SUITE/SCENARIO``)."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from irsim.diagnostics.diagnostic import Diagnostic
from irsim.diagnostics.errors import ScenarioError
from irsim.results.findings import Finding
from irsim.scenario.open import read_scenario
from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["policy_of_suite", "read_input"]


def read_input(path: str | Path | None, text: str | None, **options: Any) -> tuple[ResolvedScenario, list[Finding]]:
    """Read a scenario; see :func:`irsim.scenario.open.read_scenario`.

    Args:
        path: Path of the file, or ``SUITE/SCENARIO``, where the suite is bundled or a file.
        text: Text of the scenario, instead of ``path``.
        **options: ``strict``, ``limits`` and ``behavior``.

    Raises:
        SuiteError: ``path`` is a suite, or begins with one that has no such scenario.
        Others: as ``read_scenario``.
    """
    named = Path(path) if isinstance(path, (str, os.PathLike)) and text is None else None
    if named is not None and not named.is_file():
        from irsim.benchmarks.suite_plan import suite_scene

        if (scene := suite_scene(named)) is not None:
            return _with_findings(*read_scenario(scene.document(), **options))
    try:
        return _with_findings(*read_scenario(path, text=text, **options))
    except ScenarioError:
        if named is not None:
            from irsim.benchmarks.suite_plan import suite_scene

            suite_scene(named)  # a suite is refused with a sentence of its own
        raise


def _with_findings(scenario: ResolvedScenario, told: list[Diagnostic]) -> tuple[ResolvedScenario, list[Finding]]:
    return scenario, [Finding.of(item) for item in told]


def policy_of_suite(path: str | Path | None, policy: Any) -> Any:
    """The policy that a name means for a scenario of a suite: that of the suite, if it has one of that name.

    Args:
        path: Path of the scenario, or ``SUITE/SCENARIO``.
        policy: What :func:`irsim.run` takes as a policy.

    Raises:
        SuiteError: The suite is not valid.
    """
    if not isinstance(path, (str, os.PathLike)) or not isinstance(policy, str) or Path(path).is_file():
        return policy
    from irsim.benchmarks.suite_plan import suite_policy

    return suite_policy(path, policy)
