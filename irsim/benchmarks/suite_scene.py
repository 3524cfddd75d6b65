"""Single scenarios of suites, by names such as ``random_polygons_v1/robots-5/freeze`` or ``mine.yaml/doors/yield``."""

from __future__ import annotations

from pathlib import Path

from irsim.benchmarks.plan import PlannedScenario
from irsim.benchmarks.suite_files import SuiteError, is_suite, suite_names
from irsim.benchmarks.suite_plan import suite_plan
from irsim.diagnostics.diagnostic import nearest

__all__ = ["suite_scene"]


def suite_scene(name: str | Path) -> PlannedScenario | None:
    """The scenario of a suite that a name means; None if the name does not begin with that of a suite.

    Args:
        name: ``SUITE/SCENARIO``, where the suite is bundled or a file.

    Raises:
        SuiteError: The suite is not valid, has no such scenario, or no scenario is named.
    """
    given = Path(name)
    if given.is_file() and not is_suite(str(name)):
        return None
    for suite in (given, *given.parents):
        word = suite.as_posix()
        if word in suite_names() or (suite.is_file() and is_suite(word)):
            return _scene(word, given.relative_to(suite).as_posix())
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
