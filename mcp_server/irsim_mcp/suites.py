"""Bundled suites in the tools: ``SUITE/SCENARIO`` is a scenario wherever one is expected, and ``SUITE`` a benchmark.

The server only asks whether a suite is meant (:func:`suite_of`); workers do the rest, which needs the engine.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import irsim
from irsim.diagnostics.errors import InputError

if TYPE_CHECKING:
    from irsim.benchmarks.plan import Plan

__all__ = ["plan_of", "scenario_of_suite", "suite_of"]


@lru_cache(maxsize=1)
def _names() -> frozenset[str]:
    folders = [Path(folder, "benchmarks", "suites") for folder in irsim.__path__]
    return frozenset(path.stem for folder in folders for path in folder.glob("*.yaml"))


def suite_of(given: str) -> str | None:
    """The bundled suite that a name begins with; None without a suite, or if a file is meant."""
    if "\n" in given or given.endswith((".yaml", ".yml")):
        return None
    name = given.partition("/")[0]
    return name if name in _names() else None


def scenario_of_suite(given: str, argument: str) -> str:
    """The text of one scenario of a bundled suite.

    Args:
        given: ``SUITE/SCENARIO``.
        argument: The tool's argument, for errors.

    Raises:
        InputError: The suite has no such scenario.
    """
    from irsim.benchmarks.suite import SuiteError
    from irsim.benchmarks.suite_plan import suite_scene

    try:
        scene = suite_scene(given)
    except SuiteError as error:
        raise _wrong(error.message, error.fix or "irsim suites lists them", argument) from None
    if scene is None:
        raise _wrong(f"{given!r} is not a scenario of a suite", "irsim suites lists them", argument)
    return scene.text


def plan_of(
    scenarios: Sequence[str], policies: Sequence[str] | None, seeds: int, root: Path, first: int | None = None
) -> Plan:
    """The plan of a benchmark of a suite, or of some of its scenarios.

    Args:
        scenarios: ``SUITE``, or ``SUITE/SCENARIO`` of one suite.
        policies: Names of its policies, other behaviors, or files; default: its policies.
        seeds: Number of seeds.
        root: The workspace, in which files must lie.
        first: First seed; default: the first one of the suite.

    Raises:
        InputError: A scenario is not of the suite.
        InputError, PolicyError: A policy is not valid.
    """
    from irsim.benchmarks.policies import opened_policies
    from irsim.benchmarks.suite_plan import suite_plan

    suites = [suite_of(given) for given in scenarios]
    suite = suites[0]
    if suite is None or set(suites) != {suite}:
        what = "scenarios of a suite are benchmarked without others"
        raise _wrong(what, "give one suite, or scenarios of one suite", "scenarios")
    known = [scenario.name for scenario in _whole(suite).scenarios]
    names = [given.partition("/")[2] for given in scenarios if "/" in given]
    for name in names:
        if not any(name in (one, one.rsplit("/", 1)[0], one.split("/", 1)[0]) for one in known):
            raise _unknown(suite, known, name, "scenarios")
    own = _known_policies(suite)
    opened_policies([text for text in policies or [] if text not in own], "policies", str(root))
    return suite_plan(
        suite,
        policies=policies or None,
        seeds=seeds if first is None else list(range(first, first + seeds)),
        scenarios=names or None,
    )


@lru_cache(maxsize=8)
def _whole(suite: str) -> Plan:
    from irsim.benchmarks.suite_plan import suite_plan

    return suite_plan(suite)


def _known_policies(suite: str) -> set[str]:
    """Names of the policies of a suite, whether it runs them by itself or not."""
    known_suite = _whole(suite).suite
    return set() if known_suite is None else {*known_suite.known_policies}


def _unknown(suite: str, known: Sequence[str], given: str, argument: str) -> InputError:
    from irsim.diagnostics.diagnostic import nearest

    near = nearest(given, known)
    fix = f"did you mean {suite}/{near}?" if near else f"choose from {', '.join(known)}"
    return _wrong(f"suite {suite} has no scenario {given!r}", fix, argument)


def _wrong(what: str, fix: str, argument: str) -> InputError:
    error = InputError(what, fix)
    error.where = argument
    return error
