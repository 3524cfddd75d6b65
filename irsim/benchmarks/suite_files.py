"""Finds, reads and checks suite files: the bundled ones by name, others by path."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from pydantic import ValidationError

from irsim.benchmarks.suite import Suite
from irsim.benchmarks.suite_problems import SuiteError, problems_of, suite_error
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import is_slip_of, suggestion
from irsim.scenario.yaml.document import Document, load_path, load_text

__all__ = ["SuiteError", "is_suite", "is_suite_text", "load_suite", "read_suite", "suite_names"]

_FOLDER = Path(__file__).with_name("suites")


def suite_names() -> list[str]:
    """Names of the bundled suites, sorted."""
    return sorted(path.stem for path in _FOLDER.glob("*.yaml"))


def is_suite(word: str) -> bool:
    """Whether a word names a suite: a bundled one, perhaps misspelt, or a YAML file with the key ``suite``."""
    if word in suite_names():
        return True
    path = Path(word)
    if not path.suffix and not path.exists():
        return any(is_slip_of(word, name) for name in suite_names())
    if path.suffix not in (".yaml", ".yml") or not path.is_file():
        return False
    return _is_suite(load_path(path))


def is_suite_text(text: str) -> bool:
    """Whether a YAML text is a suite rather than a scenario."""
    return _is_suite(load_text(text))


def _is_suite(document: Document) -> bool:
    return isinstance(document.data, dict) and "suite" in document.data


def load_suite(word: str) -> tuple[Suite, Path]:
    """A suite, and the file that it was read from.

    Args:
        word: Name of a bundled suite, or path of a file.

    Raises:
        SuiteError: There is no such suite, or it is not valid.
    """
    if word in suite_names():
        path = _FOLDER / f"{word}.yaml"
    else:
        path = Path(word)
        if not path.is_file():
            known = suite_names()
            fix = suggestion(word, known, f"choose one of {', '.join(known)}, or give a file")
            raise SuiteError(f"there is no suite {clean(word)!r}", fix, "unknown-suite")
    return read_suite(path), path


def read_suite(path: Path) -> Suite:
    """Read a suite file.

    Raises:
        SuiteError: The file is not a valid suite; the message lists every problem with its place.
    """
    document = load_path(path)
    found = [replace(item, file=str(path)) for item in document.problems if item.severity == "error"]
    if found and (document.fatal or document.data is None):
        raise suite_error(path, found)
    try:
        suite = Suite.model_validate(document.data)
    except ValidationError as error:
        raise suite_error(path, [*found, *problems_of(error, document)]) from None
    if found:
        raise suite_error(path, found)
    return suite
