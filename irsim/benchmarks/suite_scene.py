"""Single scenarios of suites, by names such as ``random_polygons_v1/robots-5/freeze`` or ``mine.yaml/doors/yield``."""

from __future__ import annotations

from pathlib import Path

from irsim.benchmarks.plan import PlannedScenario
from irsim.benchmarks.suite_file import SUITES, SuiteError, is_suite, load_suite
from irsim.benchmarks.suite_plan import suite_plan
from irsim.diagnostics.diagnostic import nearest
from irsim.scenario.behavior_override import behavior_text

__all__ = ["suite_policy", "suite_scene"]


def suite_scene(name: str | Path) -> PlannedScenario | None:
    """The scenario of a suite that a name means; None if the name does not begin with that of a suite.

    Args:
        name: ``SUITE/SCENARIO``, where the suite is bundled or a file.

    Raises:
        SuiteError: The suite is not valid, has no such scenario, or no scenario is named.
    """
    found = _split(name)
    return None if found is None else _scene(*found)


def suite_policy(name: str | Path, policy: str) -> str:
    """The text of a policy; where a scenario of a suite is named and the suite has a policy of that name, its text.

    Args:
        name: ``SUITE/SCENARIO``, or another scenario.
        policy: Name of a policy, or text.

    Raises:
        SuiteError: The suite is not valid.
    """
    found = _split(name)
    suite = None if found is None else load_suite(found[0])[0]
    own = {} if suite is None else suite.known_policies
    return behavior_text(own[policy]) if policy in own else policy


def _split(name: str | Path) -> tuple[str, str] | None:
    """The suite and the scenario of a name; None if it does not begin with a suite."""
    given = Path(name)
    if given.is_file() and not is_suite(str(name)):
        return None
    for suite in (given, *given.parents):
        word = suite.as_posix()
        if word in SUITES.names() or (suite.is_file() and is_suite(word)):
            return word, given.relative_to(suite).as_posix()
    return None


def _scene(suite: str, name: str) -> PlannedScenario:
    known = {scenario.name: scenario for scenario in suite_plan(suite).scenarios}
    if name in known:
        return known[name]
    near = nearest(name, list(known)) or next(iter(known))
    if name == ".":
        fix = f"irsim benchmark {suite} runs all; a single one is named {suite}/{near}"
        raise SuiteError(f"{suite} is a suite of {len(known)} scenarios", fix)
    raise SuiteError(f"{suite} has no scenario {name!r}", f"did you mean {suite}/{near}?")
