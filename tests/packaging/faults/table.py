"""The table of faults, and where each of them stands today."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path

import yaml

__all__ = ["FOLDERS", "ROOT", "Fault", "faults", "holder", "node"]

ROOT = Path(__file__).resolve().parents[3]
FOLDERS = ("irsim", "mcp_server/irsim_mcp", "evals/irsim_evals")
"""The packages in which faults are made."""


@dataclass(frozen=True)
class Fault:
    """One slip: a text of the program, what is written in its place, and the tests that fail then."""

    name: str
    seen: str
    """The effect that a user would notice."""
    file: str
    """Where the text was found first; it may have moved since."""
    find: str
    write: str
    tests: tuple[str, ...]
    """Files of tests, or ``file::test``; each of them fails."""
    drawn: bool = False
    """Whether a mutation tool chose it."""


@functools.cache
def faults() -> dict[str, Fault]:
    """All faults of the YAML files beside this module, by name."""
    told = [
        Fault(**{**entry, "tests": tuple(entry["tests"])})
        for path in sorted(Path(__file__).parent.glob("*.yaml"))
        for entry in yaml.safe_load(path.read_text(encoding="utf-8"))
    ]
    by_name = {fault.name: fault for fault in told}
    assert len(by_name) == len(told), "two faults have one name"
    return by_name


@functools.cache
def _texts(root: Path) -> dict[Path, str]:
    """All Python files of the packages -> their text."""
    return {path: path.read_text(encoding="utf-8") for folder in FOLDERS for path in (root / folder).rglob("*.py")}


def holder(fault: Fault, root: Path = ROOT) -> Path:
    """The file of a checkout that holds the text of a fault: the one named, or else the only one that has it.

    Raises:
        LookupError: No file has the text, or it stands at several places.
    """
    named = root / fault.file
    texts = {named: _texts(root)[named]} if fault.find in _texts(root).get(named, "") else _texts(root)
    places = {path: count for path, text in texts.items() if (count := text.count(fault.find))}
    if sum(places.values()) != 1:
        told = ", ".join(f"{path.relative_to(root)} ({count})" for path, count in places.items()) or "nowhere"
        raise LookupError(f"{fault.name}: its text stands {told}; carry the fault over to the code of today")
    return next(iter(places))


@functools.cache
def _tests(root: Path) -> dict[Path, str]:
    return {path: path.read_text(encoding="utf-8") for path in (root / "tests").rglob("test_*.py")}


def node(test: str, root: Path = ROOT) -> str:
    """A test as pytest finds it today: in the file named, or else in the only one that has a function of its name.

    Raises:
        LookupError: There is no such test, or several files have one of its name.
    """
    file, _, rest = test.partition("::")
    heading = f"def {rest.rpartition('::')[2].partition('[')[0]}(" if rest else ""
    if heading in _tests(root).get(root / file, "") and root / file in _tests(root):
        return test
    places = [path for path, text in _tests(root).items() if rest and heading in text]
    if len(places) != 1:
        raise LookupError(f"{test}: {len(places)} files have this test; name the one that fails in its place")
    return f"{places[0].relative_to(root).as_posix()}::{rest}"
