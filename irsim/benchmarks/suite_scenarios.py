"""The scenarios that a suite expands to: every combination of the values that vary, under every protocol."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml

from irsim.benchmarks.suite import MAX_SCENARIOS, Protocol, Suite, SuiteScenario, label_of
from irsim.benchmarks.suite_check import Expanded, check_scenarios
from irsim.benchmarks.suite_file import SuiteError, suite_error
from irsim.bundled.templates.fill import fill, parse_path
from irsim.bundled.templates.metadata import TemplateError
from irsim.bundled.templates.store import load
from irsim.scenario.yaml.document import load_path

__all__ = ["Expanded", "expand"]


def expand(suite: Suite, file: Path) -> list[Expanded]:
    """The scenarios of a suite in the order of the file, protocol by protocol.

    Args:
        suite: The suite.
        file: Where it was read from.

    Raises:
        SuiteError: A template, file or key does not exist, or there are too many scenarios.
    """
    made: list[Expanded] = []
    for scenario in suite.scenarios:
        for values in scenario.variants():
            data = _data(scenario, values, file)
            name = "-".join([scenario.name, *(label_of(value) for value in values.values())])
            for protocol in suite.protocols:
                changed = _under(protocol, data)
                full = name if len(suite.protocols) == 1 else f"{name}/{protocol}"
                steps = scenario.steps or suite.steps
                made.append(Expanded(full, scenario.name, protocol, values, steps, changed, file.parent))
            if len(made) > MAX_SCENARIOS * len(suite.protocols):
                raise SuiteError(f"the suite has more than {MAX_SCENARIOS} scenarios", "vary fewer values")
    names = [one.name for one in made]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise SuiteError(f"two scenarios are called {twice!r}", "give other names, or values that read differently")
    check_scenarios(suite, [one for one in made if one.protocol == suite.protocols[0]], file)
    return sorted(made, key=lambda one: suite.protocols.index(one.protocol))


def _data(scenario: SuiteScenario, values: Mapping[str, Any], file: Path) -> dict[str, Any]:
    """A scenario as data.

    Raises:
        SuiteError: It cannot be made.
    """
    folder = file.parent
    if scenario.template is not None:
        try:
            text = fill(load(scenario.template), {**scenario.parameters, **values})
        except TemplateError as error:
            raise SuiteError(f"scenario {scenario.name!r}: {error.message}", error.fix or "") from None
        return dict(yaml.safe_load(text))
    if scenario.file is not None:
        document = load_path(folder / scenario.file)
        problems = [item for item in document.problems if item.severity == "error"]
        if document.fatal or not isinstance(document.data, Mapping):
            raise SuiteError(
                f"scenario {scenario.name!r}: {scenario.file} is not a scenario file", "give a path from the suite file"
            )
        if problems:
            raise suite_error(file, [replace(item, file=str(folder / scenario.file)) for item in problems])
        data: Any = dict(document.data)
    else:
        data = deepcopy(scenario.scenario)
    for path, value in values.items():
        _set(data, path, value, scenario.name)
    return dict(data)


def _set(data: Any, path: str, value: Any, name: str) -> None:
    """Change the value at a path of a scenario.

    Raises:
        SuiteError: There is nothing at the path whose value could be changed.
    """
    *way, last = parse_path(path)
    try:
        for part in way:
            data = data[part]
        data[last] = value
    except (LookupError, TypeError):
        raise SuiteError(
            f"scenario {name!r} has nothing at {path!r}",
            "write a path such as robot[0].number, with keys that exist",
        ) from None


def _under(protocol: Protocol, data: Mapping[str, Any]) -> dict[str, Any]:
    if protocol == "as-written":
        return dict(data)
    return {**data, "world": {**(data.get("world") or {}), "after_arrival": protocol}}
