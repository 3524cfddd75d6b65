"""Reads every scenario of a suite strictly, so that a misspelt key is an error and not a value without effect."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import yaml

from irsim.benchmarks.suite import Protocol, Suite, SuiteScenario
from irsim.benchmarks.suite_file import suite_error
from irsim.bundled.templates.fill import parse_path
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic, format_path, nearest
from irsim.scenario.messages.translate import located
from irsim.scenario.read import read
from irsim.scenario.yaml.document import Document, load_path, load_text

__all__ = ["Expanded", "check_scenarios"]


@dataclass(frozen=True)
class Expanded:
    """One scenario of a suite.

    Attributes:
        name: Name in the results.
        family: Name in the suite.
        protocol: What robots do that have arrived.
        values: The values that vary in its family.
        steps: Horizon in steps.
        data: The scenario.
        folder: Folder relative to which it names other files.
    """

    name: str
    family: str
    protocol: Protocol
    values: Mapping[str, Any]
    steps: int
    data: dict[str, Any] = field(repr=False)
    folder: Path = field(repr=False)


def check_scenarios(suite: Suite, made: Sequence[Expanded], file: Path) -> None:
    """Check that scenarios of a suite have only keys and values that count.

    Args:
        suite: The suite.
        made: Its scenarios, each under one protocol.
        file: Where it was read from.

    Raises:
        SuiteError: A scenario has errors, or what IR-SIM 2.12 would ignore.
    """
    found: dict[tuple[Any, ...], Diagnostic] = {}
    for one in made:
        text = yaml.safe_dump(one.data, sort_keys=False, allow_unicode=True)
        document = load_text(text, name=one.name, path=str(one.folder / "scenario.yaml"))
        for item in read(document, strict=True).errors:
            found.setdefault((one.family, item.code, item.path, item.message), _of_suite(item, one, suite))
    if found:
        written = load_path(file) if file.is_file() else Document(None)
        raise suite_error(file, [_placed(item, suite, written, file) for item in found.values()])


def _of_suite(item: Diagnostic, one: Expanded, suite: Suite) -> Diagnostic:
    """A problem of a scenario as one of its suite: with the name of the scenario and the path in the suite file."""
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
    return replace(item, path=path, message=message, fix=fix, line=None, column=None, edit=None, severity="error")


def _varied(item: Diagnostic, values: Mapping[str, Any]) -> str | None:
    """The key of ``vary`` that a problem of a scenario is about, if it is about one."""
    return next((key for key in values if item.path[: len(parse_path(key))] == parse_path(key)), None)


def _place_in_vary(scenario: SuiteScenario, key: str, values: Mapping[str, Any]) -> tuple[str | int, ...]:
    if isinstance(scenario.vary, Mapping):
        return ("vary", key)
    return ("vary", scenario.vary.index(dict(values)), key)


def _placed(item: Diagnostic, suite: Suite, written: Document, file: Path) -> Diagnostic:
    """A problem with its position: in the suite file, or in the scenario file that the suite names."""
    if not (isinstance(written.data, Mapping) and written.data.get("suite") == suite.suite):
        return item
    if item.path[2:3] == ("file",):
        named = file.parent / str(suite.scenarios[int(item.path[1])].file)
        return located(replace(item, path=item.path[3:]), load_path(named))
    return located(item, written)
