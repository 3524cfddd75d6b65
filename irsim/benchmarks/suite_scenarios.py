"""The scenarios that a suite expands to: every combination of the values that vary, under every protocol.

All of them are read strictly, so that a misspelt key is an error and not a value without effect.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import yaml

from irsim.benchmarks.roles import COMPARED
from irsim.benchmarks.suite import MAX_SCENARIOS, Protocol, Suite, SuiteError, SuiteScenario, label_of, suite_error
from irsim.bundled.templates.fill import fill, parse_path
from irsim.bundled.templates.store import TemplateError, load
from irsim.common.text import clean, listed
from irsim.common.yaml.plain import read_plain_yaml
from irsim.diagnostics.diagnostic import Diagnostic, format_path, nearest
from irsim.diagnostics.errors import InputError
from irsim.policies.catalog import is_network
from irsim.policies.parts import OTHERS
from irsim.scenario.behavior_override import AS_WRITTEN, behavior_text, parse_behavior
from irsim.scenario.messages.translate import located
from irsim.scenario.read import read
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.document import Document, load_path, load_text

__all__ = ["Expanded", "expand", "of_suite", "placed", "step_time_of", "under_each_policy"]


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
            data = _data(scenario, values, file, {**suite.overrides, **scenario.overrides})
            name = "-".join([scenario.name, *(label_of(value) for value in values.values())])
            for protocol in suite.protocols:
                changed = _under(protocol, data)
                full = name if len(suite.protocols) == 1 else f"{name}/{protocol}"
                steps = scenario.steps or suite.horizon(step_time_of(data))
                parts = {key: behavior_text(one) for key, one in scenario.policies.items()}
                made.append(Expanded(full, scenario.name, protocol, values, steps, changed, file.parent, parts))
            if len(made) > MAX_SCENARIOS * len(suite.protocols):
                raise SuiteError(f"the suite has more than {MAX_SCENARIOS} scenarios", "vary fewer values")
    names = [one.name for one in made]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise SuiteError(f"two scenarios are called {twice!r}", "give other names, or values that read differently")
    check_scenarios(suite, [one for one in made if one.protocol == suite.protocols[0]], file)
    return sorted(made, key=lambda one: suite.protocols.index(one.protocol))


def step_time_of(data: Mapping[str, Any]) -> float:
    """The period of a scenario, given as data [s]."""
    return float((data.get("world") or {}).get("step_time") or 0.1)


def _data(scenario: SuiteScenario, values: Mapping[str, Any], file: Path, always: Mapping[str, Any]) -> dict[str, Any]:
    """A scenario as data, with its own values and the values of all scenarios of the suite.

    Raises:
        SuiteError: It cannot be made.
    """
    folder = file.parent
    data: Any
    if scenario.template is not None:
        known = {key: value for key, value in values.items() if len(parse_path(key)) == 1}
        try:
            text = fill(load(scenario.template), {**scenario.parameters, **known})
        except TemplateError as error:
            raise SuiteError(f"scenario {scenario.name!r}: {error.message}", error.fix or "") from None
        data, values = dict(read_plain_yaml(text)), {key: value for key, value in values.items() if key not in known}
    elif scenario.file is not None:
        document = load_path(folder / scenario.file)
        problems = [item for item in document.problems if item.severity == "error"]
        if document.fatal or not isinstance(document.data, Mapping):
            raise SuiteError(
                f"scenario {scenario.name!r}: {scenario.file} is not a scenario file", "give a path from the suite file"
            )
        if problems:
            raise suite_error(file, [replace(item, file=str(folder / scenario.file)) for item in problems])
        data = dict(document.data)
    else:
        data = deepcopy(scenario.scenario)
    for path, value in {**always, **values}.items():
        _set(data, path, value, scenario.name)
    return dict(data)


def _set(data: Any, path: str, value: Any, name: str) -> None:
    """Change the value at a path of a scenario.

    Raises:
        SuiteError: There is nothing at the path whose value could be changed.
    """
    *way, last = parse_path(path)
    try:
        for place in _places(data, way):
            place[last] = value
    except (LookupError, TypeError):
        raise SuiteError(
            f"scenario {name!r} has nothing at {path!r}",
            "write a path such as robot[0].number, with keys that exist",
        ) from None


def _places(data: Any, way: Sequence[str | int]) -> list[Any]:
    """The values at a path, of which the part ``*`` is each entry of a list, or a single entry without a list."""
    places = [data]
    for part in way:
        if part == "*":
            places = [one for place in places for one in (place if isinstance(place, list) else [place])]
        else:
            places = [place[part] for place in places]
    return places


def _under(protocol: Protocol, data: Mapping[str, Any]) -> dict[str, Any]:
    if protocol == "as-written":
        return dict(data)
    return {**data, "world": {**(data.get("world") or {}), "after_arrival": protocol}}


@dataclass(frozen=True)
class Expanded:
    """One scenario of a suite.

    Attributes:
        name: Name in the results.
        family: Name in the suite.
        protocol: Behavior of robots that have arrived.
        values: The values that vary in its family.
        steps: Horizon in steps.
        data: The scenario.
        folder: Folder relative to which it names other files.
        policies: Name or tag of robots → name or text of the policy that drives them, or ``compared``.
    """

    name: str
    family: str
    protocol: Protocol
    values: Mapping[str, Any]
    steps: int
    data: dict[str, Any] = field(repr=False)
    folder: Path = field(repr=False)
    policies: dict[str, str] = field(default_factory=dict)

    def document(self, data: Mapping[str, Any] | None = None) -> Document:
        """The scenario, or another one in its place, ready to read."""
        text = yaml.safe_dump(dict(self.data if data is None else data), sort_keys=False, allow_unicode=True)
        return load_text(text, name=self.name, path=str(self.folder / "scenario.yaml"))


def check_scenarios(suite: Suite, made: Sequence[Expanded], file: Path) -> None:
    """Check that scenarios of a suite have only keys and values that count.

    Args:
        suite: The suite.
        made: Its scenarios, each under one protocol.
        file: Where it was read from.

    Raises:
        SuiteError: A scenario has errors, or what IR-SIM 2.12 would ignore.
    """
    problems: dict[tuple[Any, ...], Diagnostic] = {}
    for one in made:
        reading = read(one.document(), strict=True)
        for item in reading.errors:
            problems.setdefault((one.family, item.code, item.path, item.message), of_suite(item, one, suite))
        for item in [] if reading.scenario is None else _unknown_robots(one, suite, reading.scenario):
            problems.setdefault((one.family, item.code, item.path, item.message), item)
    if problems:
        raise suite_error(file, placed(list(problems.values()), suite, file))


def _unknown_robots(one: Expanded, suite: Suite, scenario: ResolvedScenario) -> Iterator[Diagnostic]:
    """The names and tags under ``policies`` that no robot of the scenario has."""
    robots = scenario.robots()
    known = list(dict.fromkeys([*(tag for robot in robots for tag in robot.tags), *(robot.name for robot in robots)]))
    index = next(number for number, each in enumerate(suite.scenarios) if each.name == one.family)
    for key in one.policies:
        if key not in (*known, OTHERS):
            near = nearest(key, known)
            message = f"scenario {one.family!r}: no robot has the name or tag {clean(key)!r}"
            fix = f"did you mean {clean(near)}?" if near else f"choose from {listed([*known, OTHERS], 10)}"
            yield Diagnostic(
                "invalid-value", "error", ("scenarios", index, "policies", key), message, given=key, fix=fix
            )


def of_suite(item: Diagnostic, one: Expanded, suite: Suite) -> Diagnostic:
    """A finding of a scenario as one of its suite: with the name of the scenario and the path in the suite file."""
    index = next(number for number, each in enumerate(suite.scenarios) if each.name == one.family)
    where = format_path(item.path)
    message, fix = f"scenario {one.family!r}: {where}: {item.message}", item.fix
    path: tuple[str | int, ...] = ("scenarios", index)
    varied = _varied(item, one.values)
    if varied is not None:
        path = (*path, *_place_in_vary(suite.scenarios[index], varied, one.values))
        if item.code == "unknown-key":
            near = nearest(str(item.path[-1]), item.allowed if isinstance(item.allowed, list) else ())
            message = f"scenario {one.family!r} has no key {clean(where, 100)}"
            fix = f"did you mean {near}?" if near else None
    elif suite.scenarios[index].scenario is not None:
        path = (*path, "scenario", *item.path)
    elif suite.scenarios[index].file is not None:
        path = (*path, "file", *item.path)
    return replace(item, path=path, message=message, fix=fix, line=None, column=None, edit=None)


def _varied(item: Diagnostic, values: Mapping[str, Any]) -> str | None:
    """The key of ``vary`` that a problem of a scenario is about, if it is about one."""
    return next((key for key in values if item.path[: len(parse_path(key))] == parse_path(key)), None)


def _place_in_vary(scenario: SuiteScenario, key: str, values: Mapping[str, Any]) -> tuple[str | int, ...]:
    if isinstance(scenario.vary, Mapping):
        return ("vary", key)
    return ("vary", scenario.vary.index(dict(values)), key)


def placed(items: Sequence[Diagnostic], suite: Suite, file: Path) -> list[Diagnostic]:
    """Findings with their position: in the suite file, or in the scenario file that the suite names.

    Args:
        items: Findings of the suite, see :func:`of_suite`.
        suite: The suite.
        file: Where it was read from.
    """
    written = load_path(file) if file.is_file() else Document(None)
    return [_placed(item, suite, written, file) for item in items]


def _placed(item: Diagnostic, suite: Suite, written: Document, file: Path) -> Diagnostic:
    """A problem with its position: in the suite file, or in the scenario file that the suite names."""
    if not (isinstance(written.data, Mapping) and written.data.get("suite") == suite.suite):
        return item
    if item.path[2:3] == ("file",):
        named = file.parent / str(suite.scenarios[int(item.path[1])].file)
        return located(replace(item, path=item.path[3:]), load_path(named))
    return located(item, written)


def under_each_policy(one: Expanded, suite: Suite) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """A scenario of a suite under each behavior that the suite compares, with the name of the policy."""
    texts = {name: behavior_text(policy) for name, policy in suite.policies.items()}
    for name, text in texts.items():
        if text == AS_WRITTEN or is_network(text):
            continue
        try:
            options = parse_behavior(text)
        except InputError:
            continue
        mine = {key for key, part in one.policies.items() if part == COMPARED}
        entries = [
            _with(entry, options) if not mine or mine & _called(entry) else entry
            for entry in _entries(one.data.get("robot"))
        ]
        yield name, {**one.data, "robot": entries}


def _entries(given: Any) -> list[dict[str, Any]]:
    entries = given if isinstance(given, list) else [] if given is None else [given]
    return [dict(entry) for entry in entries]


def _called(entry: Mapping[str, Any]) -> set[Any]:
    """Names and tags of an entry."""
    name, tags = entry.get("name"), entry.get("tags") or ()
    return {*(name if isinstance(name, list) else [name]), *([tags] if isinstance(tags, str) else tags)}


def _with(entry: dict[str, Any], options: Mapping[str, Any] | None) -> dict[str, Any]:
    """An entry of robots whose behavior is another one."""
    return {**{key: value for key, value in entry.items() if key != "group_behavior"}, "behavior": options}
