"""Finds, reads and checks suite files: the bundled ones by name, others by path."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import ValidationError

from irsim.benchmarks.suite import Suite
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import format_path, nearest, suggestion
from irsim.diagnostics.errors import CodedError
from irsim.scenario.yaml.document import load_path

__all__ = ["SuiteError", "is_suite", "load_suite", "read_suite", "suite_names"]

_FOLDER = Path(__file__).with_name("suites")


class SuiteError(CodedError, ValueError):
    """A suite file cannot be used; the message lists every problem."""

    def __init__(self, message: str, fix: str, code: str = "bad-suite") -> None:
        super().__init__(code, message, fix)


def suite_names() -> list[str]:
    """Names of the bundled suites, sorted."""
    return sorted(path.stem for path in _FOLDER.glob("*.yaml"))


def is_suite(word: str) -> bool:
    """Whether a word names a suite: a bundled one, or a YAML file with the key ``suite``."""
    if word in suite_names():
        return True
    path = Path(word)
    if path.suffix not in (".yaml", ".yml") or not path.is_file():
        return False
    data = load_path(path).data
    return isinstance(data, dict) and "suite" in data


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
    if document.fatal or not isinstance(document.data, dict):
        why = "; ".join(item.message for item in document.problems[:3]) or "it is not a mapping"
        raise SuiteError(f"{path} is not a suite: {why}", "compare it with irsim describe random_polygons_v1")
    try:
        return Suite.model_validate(document.data)
    except ValidationError as error:
        problems = [_words(item) for item in error.errors(include_url=False)]
        raise SuiteError(
            f"{path} is not a valid suite: {'; '.join(problems)}", "compare it with irsim describe random_polygons_v1"
        ) from None


def _words(item: Any) -> str:
    """One problem, with its place and the key that was probably meant."""
    where = format_path(item["loc"]) or "the suite"
    if item["type"] == "extra_forbidden":
        known = _keys_at(item["loc"][:-1])
        near = nearest(str(item["loc"][-1]), known)
        return f"{where}: there is no such key" + (f", did you mean {near}?" if near else "")
    if item["type"] == "missing":
        return f"{where}: this key is missing"
    return f"{where}: {clean(str(item['msg']).removeprefix('Value error, '), 200)}"


def _keys_at(place: tuple[Any, ...]) -> list[str]:
    from irsim.benchmarks.suite import Seeds, SuiteScenario

    model = Seeds if place[:1] == ("seeds",) else SuiteScenario if place[:1] == ("scenarios",) else Suite
    return list(model.model_fields)
