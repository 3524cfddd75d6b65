"""Reads what commands take as a scenario: a file, a text, or a scenario of a suite (``SUITE/SCENARIO``)."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from irsim.diagnostics.errors import InputError, ScenarioError
from irsim.policies.behavior import BehaviorPolicy
from irsim.policies.catalog import open_policy
from irsim.policies.policy import Policy
from irsim.results.findings import Finding
from irsim.scenario.behavior_override import AS_WRITTEN
from irsim.scenario.limits import Limits
from irsim.scenario.open import read_scenario as read_one
from irsim.scenario.perturbation import Perturbations, perturbed, read_perturbations
from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["in_suite", "opened_policy", "policy_of_suite", "read_scenario", "rules_of_suite"]


def read_scenario(
    path: str | Path | None = None,
    *,
    text: str | None = None,
    strict: bool,
    limits: Limits | None = None,
    behavior: str | None = None,
    perturb: Perturbations | None = None,
) -> tuple[ResolvedScenario, list[Finding]]:
    """Read a scenario from a file, a suite or a text; see :func:`irsim.scenario.open.read_scenario`.

    Args:
        path: Path of the file, or ``SUITE/SCENARIO``, where the suite is bundled or a file.
        text: Text of the scenario, instead of ``path``.
        strict: Refuse what IR-SIM would ignore.
        limits: Limits of the loader.
        behavior: Replaces every robot's own behavior.
        perturb: Perturbations; default: the suite's, if ``path`` is of one.

    Returns:
        The scenario, ready to build, and the warnings and hints about it.

    Raises:
        SuiteError: ``path`` is a suite, or begins with one that has no such scenario.
        Others: as ``irsim.scenario.open.read_scenario``.
    """
    suited = in_suite(path, text)
    scene = None if suited is None else _suites().suite_scene(suited)
    try:
        source = path if scene is None else scene.document()
        scenario, diagnostics = read_one(source, text=text, strict=strict, limits=limits, behavior=behavior)
    except ScenarioError:
        if scene is None and text is None and isinstance(path, (str, os.PathLike)):
            _suites().suite_scene(Path(path))  # a suite is refused with a sentence of its own
        raise
    given = rules_of_suite(path, text)[0] if perturb is None else perturb
    scenario = perturbed(scenario, read_perturbations(given)) if given else scenario
    return scenario, [Finding.of(item) for item in diagnostics]


def rules_of_suite(path: Any, text: str | None = None) -> tuple[list[str], str]:
    """Perturbations and the end of an episode that a suite adds to ``SUITE/SCENARIO``; of other scenarios none.

    Args:
        path: As :func:`irsim.run` takes it.
        text: The same.

    Raises:
        SuiteError: The suite is not valid.
    """
    suited = in_suite(path, text)
    return ([], "done") if suited is None else _suites().suite_rules(suited) or ([], "done")


def in_suite(path: Any, text: str | None = None) -> Path | None:
    """A path that may be ``SUITE/SCENARIO``, because it names no file; None for anything else.

    Args:
        path: As :func:`irsim.run` takes it.
        text: The same.
    """
    named = isinstance(path, (str, os.PathLike)) and text is None
    return Path(path) if named and not Path(path).is_file() else None


def _suites() -> Any:
    """The module of suites, which few scenarios need."""
    from irsim.benchmarks import suite_plan

    return suite_plan


def policy_of_suite(path: str | Path | None, policy: Any) -> Any:
    """The policy that a name means for a scenario of a suite, which may have a policy of this name.

    Args:
        path: Path of the scenario, or ``SUITE/SCENARIO``.
        policy: As :func:`irsim.run` takes it.

    Raises:
        SuiteError: The suite is not valid.
    """
    suited = in_suite(path) if isinstance(policy, str) else None
    return policy if suited is None else _suites().suite_policy(suited, policy)


def opened_policy(
    path: str | Path | None, policy: Any, behavior: Any, limits: Limits | None
) -> tuple[Policy | None, str | None]:
    """Open what drives the robots: a policy in Python, or the text of a behavior that runs in the engine, or neither.

    Raises:
        InputError: There is no such policy, or both names of the argument are used.
    """
    if policy is not None and behavior is not None:
        raise InputError("policy and behavior are two names of one argument", "give only policy")
    given, where = (behavior, "behavior") if policy is None else (policy, "policy")
    driver = policy_of_suite(path, AS_WRITTEN if given is None else given)
    if given is None and driver == AS_WRITTEN:
        return None, None
    try:
        opened = open_policy(driver, root=None if limits is None else limits.root)
    except InputError as error:
        error.where = where
        raise
    if isinstance(opened, BehaviorPolicy):
        return None, None if opened.text == AS_WRITTEN else opened.text
    return opened, None
