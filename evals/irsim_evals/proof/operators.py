"""Parts of mutants and rewrites: their registers, and ways to go through a scenario, change it and write it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any, TypeGuard

import yaml

from irsim.common.arguments import is_number
from irsim.scenario.model.lookup import at
from irsim_evals.grader.scene import GradedScene

__all__ = [
    "LOADER", "NUMBER", "OPERATORS", "REWRITES", "Change", "Data", "component", "dump", "each_entry", "entries",
    "is_pose", "items_of", "operator", "plain", "rewrite", "sensors_of",
]  # fmt: skip

Data = dict[str, Any]
Change = Iterator[tuple[str, Data]]
"""Changed scenarios, each with the change in words."""
Operator = Callable[[Data], Change]
OPERATORS: dict[str, Operator] = {}
Rewrite = Callable[[str, Data, GradedScene], str | None]
REWRITES: dict[str, Rewrite] = {}
NUMBER = re.compile(r"(?<![\w.#\"'-])(-?\d+(?:\.\d+)?)(?![\w.:\"'])")
"""A number in the text of a scenario."""
_DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
"""Those in C are ten times as fast; some installations lack them."""


def operator(function: Operator) -> Operator:
    """Register an operator under its name."""
    OPERATORS[function.__name__] = function
    return function


def plain(value: Any) -> Any:
    """A copy in which no two keys share a mapping, as they do where a file uses anchors, so that a change of one entry
    changes no other."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    return [plain(item) for item in value] if isinstance(value, list) else value


def items_of(data: Data, section: str) -> list[Any]:
    """The entries of a section, which a file may write as a list or as a single one."""
    given = data.get(section)
    return given if isinstance(given, list) else [given] if isinstance(given, dict) else []


def entries(data: Data) -> Iterator[tuple[str, int, Data]]:
    """Section, number and mapping of each entry."""
    for section in ("robot", "obstacle"):
        for number, entry in enumerate(items_of(data, section)):
            if isinstance(entry, dict):
                yield section, number, entry


def sensors_of(entry: Data) -> list[Data]:
    """The sensors of an entry."""
    return [sensor for sensor in entry.get("sensors") or [] if isinstance(sensor, dict)]


def is_pose(value: Any) -> TypeGuard[list[Any]]:
    """Whether a value is one pose or one point, rather than a list of them."""
    return isinstance(value, list) and len(value) > 1 and is_number(value[0])


def _changeable(data: Data, section: str, number: int) -> tuple[Data, Data]:
    """A scenario with a copy of one entry, and that copy, which can be changed in place; all else is shared."""
    given, entry = data[section], plain(items_of(data, section)[number])
    made = [*given[:number], entry, *given[number + 1 :]] if isinstance(given, list) else entry
    return {**data, section: made}, entry


def each_entry(data: Data, change: Callable[[Data], Any], what: str) -> Change:
    """For each entry a copy in which it was changed in place; none where the change returns False."""
    for section, number, _ in entries(data):
        made, entry = _changeable(data, section, number)
        if change(entry) is not False:
            yield f"{section}[{number}]: {what}", made


def component(key: str, part: int | str, new: Callable[[float], float]) -> Callable[[Data], bool]:
    """A change of one number of the list or the mapping under a key."""

    def change(entry: Data) -> bool:
        value = at(entry, (key, part))
        if is_number(value):
            entry[key][part] = new(value)
        return is_number(value)

    return change


def rewrite(function: Rewrite) -> Rewrite:
    """Register a rewrite under its name."""
    REWRITES[function.__name__] = function
    return function


def dump(data: Data, **options: Any) -> str:
    """A scenario as text."""
    return str(yaml.dump(data, Dumper=_DUMPER, sort_keys=False, allow_unicode=True, **options))
