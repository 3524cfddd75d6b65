"""Bundled suites in the tools: ``SUITE/SCENARIO`` is a scenario wherever one is expected, and ``SUITE`` a benchmark."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from irsim_mcp.errors import failure

if TYPE_CHECKING:
    from irsim.benchmarks.plan import Plan

__all__ = ["plan_of", "scenario_of_suite"]


def scenario_of_suite(given: str, argument: str) -> str | None:
    """The text of one scenario of a bundled suite; None if the given name does not begin with that of a suite.

    Raises:
        ToolError: The suite has no such scenario.
    """
    suite = _suite_of(given)
    if suite is None:
        return None
    known = {scenario.name: scenario.text for scenario in _whole(suite).scenarios}
    name = given.partition("/")[2]
    if name not in known:
        raise _unknown(f"suite {suite} has no scenario {name!r}", suite, list(known), name, argument)
    return known[name]


def plan_of(
    scenarios: Sequence[str], policies: Sequence[str] | None, seeds: int, first: int, root: Path
) -> Plan | None:
    """The plan of a benchmark of a suite, or of some of its scenarios; None for other scenarios.

    Args:
        scenarios: ``SUITE``, or ``SUITE/SCENARIO`` of one suite.
        policies: Names of its policies, other behaviors, or files; default: its policies.
        seeds: Number of seeds.
        first: The first seed that is asked for; must be 0, as a suite has its own.
        root: The workspace, in which files must lie.

    Raises:
        ToolError: A scenario is not of the suite, or a seed is given.
        BenchmarkError, PolicyError: A policy is not valid.
    """
    from irsim.benchmarks.suite_plan import suite_plan

    suites = [_suite_of(given) for given in scenarios]
    suite = suites[0]
    if not any(suites):
        return None
    if suite is None or set(suites) != {suite}:
        what = "scenarios of a suite are benchmarked without others"
        raise failure("bad-argument", what, where="scenarios", fix="give one suite, or scenarios of one suite")
    if first:
        what = "a suite has its own seeds"
        raise failure("bad-argument", what, where="first_seed", fix="leave first_seed out; seeds is their number")
    known = [scenario.name for scenario in _whole(suite).scenarios]
    names = [given.partition("/")[2] for given in scenarios if "/" in given]
    for name in names:
        if not any(name in (one, one.rsplit("/", 1)[0], one.split("/", 1)[0]) for one in known):
            raise _unknown(f"suite {suite} has no scenario {name!r}", suite, known, name, "scenarios")
    own = _whole(suite).policies
    chosen = [text if text in own else _inside(text, root) for text in policies] if policies else None
    return suite_plan(suite, policies=chosen, seeds=seeds, scenarios=names or None)


def _inside(text: str, root: Path) -> str:
    """A policy that is not one of the suite, as text that opens it from any folder."""
    from irsim.policies.catalog import open_policy

    return open_policy(text, root=root).source or text


def _suite_of(given: str) -> str | None:
    """The bundled suite that a name begins with; None if there is none, or a file has that name."""
    if "\n" in given or given.endswith((".yaml", ".yml")):
        return None
    from irsim.benchmarks.suite_files import suite_names

    name = given.partition("/")[0]
    return name if name in suite_names() else None


@lru_cache(maxsize=8)
def _whole(suite: str) -> Plan:
    from irsim.benchmarks.suite_plan import suite_plan

    return suite_plan(suite)


def _unknown(what: str, suite: str, known: Sequence[str], given: str, argument: str) -> Exception:
    from irsim.diagnostics.diagnostic import nearest

    near = nearest(given, known)
    fix = f"did you mean {suite}/{near}?" if near else f"choose from {', '.join(known)}"
    return failure("bad-argument", what, where=argument, fix=fix)
