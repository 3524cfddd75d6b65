"""Parts of mutants and rewrites: their registers, and ways to go through a scenario, change it and write it."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import yaml

from irsim_evals.grader.scene import GradedScene

__all__ = [
    "OPERATORS", "REWRITES", "Change", "Data", "Mutant", "component", "dump", "each_entry", "entries", "items_of",
    "operator", "plain", "rewrite", "scale", "with_entry",
]  # fmt: skip

Data = dict[str, Any]
Change = Iterator[tuple[str, Data]]
Operator = Callable[[Data], Change]
OPERATORS: dict[str, Operator] = {}
Rewrite = Callable[[str, Data, GradedScene], str | None]
REWRITES: dict[str, Rewrite] = {}
_DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
"""The one in C is ten times as fast; some installations lack it."""


@dataclass(frozen=True)
class Mutant:
    """One changed scenario.

    Attributes:
        operator: Name of the operator that made it.
        what: The change, for people.
        data: The scenario.
    """

    operator: str
    what: str
    data: Data


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


def with_entry(data: Data, section: str, number: int, change: Callable[[Data], Any]) -> Data | None:
    """A copy in which one entry was changed in place; None if the change does not apply."""
    made = copy.deepcopy(data)
    for other, k, entry in entries(made):
        if (other, k) == (section, number):
            return made if change(entry) is not False else None
    return None


def each_entry(data: Data, change: Callable[[Data], Any], what: str) -> Change:
    for section, number, _ in entries(data):
        made = with_entry(data, section, number, change)
        if made is not None:
            yield f"{section}[{number}]: {what}", made


def scale(key: str, factor: float, *, inside: str | None = None) -> Callable[[Data], Any]:
    def change(entry: Data) -> Any:
        owner = entry.get(inside) if inside else entry
        if not isinstance(owner, dict) or not isinstance(owner.get(key), (int, float)):
            return False
        owner[key] = owner[key] * factor
        return True

    return change


def component(key: str, number: int, new: Callable[[float], float]) -> Callable[[Data], Any]:
    """A change of one number of a list."""

    def change(entry: Data) -> Any:
        value = entry.get(key)
        if not isinstance(value, list) or len(value) <= number or not isinstance(value[number], (int, float)):
            return False
        value[number] = new(value[number])
        return True

    return change


def rewrite(function: Rewrite) -> Rewrite:
    """Register a rewrite under its name."""
    REWRITES[function.__name__] = function
    return function


def dump(data: Data, **options: Any) -> str:
    """A scenario as text."""
    return str(yaml.dump(data, Dumper=_DUMPER, sort_keys=False, allow_unicode=True, **options))
