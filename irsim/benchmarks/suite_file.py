"""Suite files: the bundled ones and those of users, read and checked; problems are told with key and line."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from irsim.benchmarks.suite import Suite
from irsim.common.arguments import as_given
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic, format_path, suggestion
from irsim.diagnostics.diagnostic import Path as Path_
from irsim.diagnostics.errors import CodedError
from irsim.scenario.file_kind import MOST_PROBLEMS, FileKind, explained
from irsim.scenario.yaml.document import Document, load_path

__all__ = ["SUITES", "SuiteError", "is_suite", "load_suite", "suite_error"]

_FIX = "irsim describe suites lists the keys of a suite file and has an example"
_VARY = "a mapping of each key to a list of values, or a list of mappings, each of which is one scenario"
_POLICY = "the name of a behavior, or a mapping such as {name: orca, timeHorizon: 2}"


class SuiteError(CodedError, ValueError):
    """A suite file cannot be used; the message lists every problem.

    Attributes:
        diagnostics: The problems with their keys and lines; empty if the problem is not one of the file.
    """

    def __init__(self, message: str, fix: str, code: str = "bad-suite", diagnostics: Sequence[Diagnostic] = ()) -> None:
        self.diagnostics = list(diagnostics)
        super().__init__(code, message, fix)


def suite_error(path: Path | str, found: Sequence[Diagnostic]) -> SuiteError:
    """The error of a suite file with these problems.

    Args:
        path: The suite file.
        found: At least one problem.
    """
    texts = [_text(item, str(path), alone=len(found) == 1) for item in found[:MOST_PROBLEMS]]
    texts += [f"and {len(found) - MOST_PROBLEMS} more"] if len(found) > MOST_PROBLEMS else []
    fix = found[0].fix if len(found) == 1 else None
    return SuiteError(
        f"{clean(path, 200)} is not a valid suite: {'; '.join(texts)}",
        _FIX if not fix or _is_guess(fix) else fix,
        diagnostics=found,
    )


def load_suite(word: str) -> tuple[Suite, Path]:
    """A suite, and the file that it was read from.

    Args:
        word: Name of a bundled suite, or path of a file.

    Raises:
        SuiteError: There is no such suite, or it is not valid.
    """
    known = SUITES.names()
    path = SUITES.bundled(word) if word in known else Path(word)
    if not path.is_file():
        fix = suggestion(word, known, f"choose one of {', '.join(known)}, or give a file")
        raise SuiteError(f"there is no suite {clean(word)!r}", fix, "unknown-suite")
    return SUITES.read(load_path(path)), path


def is_suite(word: str) -> bool:
    """Whether a word names a suite: a bundled one, perhaps misspelt, or a YAML file with the key ``suite``."""
    return SUITES.is_named(word) or SUITES.is_file(word)


def _text(item: Diagnostic, path: str, *, alone: bool) -> str:
    """A problem as part of a sentence."""
    place = [] if item.file in (None, path) else [clean(item.file, 100)]
    place += [] if item.line is None else [f"line {item.line}"]
    text = item.message
    if not text.startswith("scenario ") and item.path:
        text = f"{clean(format_path(item.path), 100)}: {text}"
    if item.code == "unknown-value" and isinstance(item.allowed, Sequence) and not isinstance(item.allowed, str):
        text += f"; choose from {', '.join(map(str, item.allowed))}"
    if item.fix and _is_guess(item.fix):
        text += f", {item.fix}"
    elif item.fix and not alone:
        text += f" ({item.fix})"
    return f"{', '.join(place)}: {text}" if place else text


def _is_guess(fix: str) -> bool:
    return fix.startswith("did you mean")


def _explain(failure: ValidationError, document: Document, model: type[BaseModel]) -> list[Diagnostic]:
    """The problems of a validation, one for each key; those of keys with several forms say what the forms are."""
    found: dict[Path_, Diagnostic] = {}
    for item in failure.errors(include_url=False):
        if (special := _special(tuple(item["loc"]), document.data)) is not None:
            found.setdefault(special.path, special)
    for problem in explained(failure, document, model):
        if _special(tuple(problem.path), document.data) is None:
            found.setdefault(problem.path, problem)
    return list(found.values())


def _special(path: Path_, data: Any) -> Diagnostic | None:
    """The problem of a key whose value may have several forms, for which pydantic lists a problem of each form."""
    if path[:1] == ("policies",) and len(path) > 2 and path[2] != "[key]":
        return _error("wrong-type", path[:2], f"must be {_POLICY}, got {as_given(data['policies'][path[1]])}")
    if path[:1] != ("scenarios",) or len(path) < 4:
        return None
    scenario = data["scenarios"][path[1]]
    if path[2] == "parameters":
        given = as_given(scenario["parameters"][path[3]])
        return _error("wrong-type", path[:4], f"must be a number, true, false or text, got {given}")
    if path[2] != "vary":
        return None
    vary = scenario["vary"]
    if isinstance(vary, dict):
        for key, values in vary.items():
            if not isinstance(values, list) or not values:
                place = (*path[:3], str(key))
                return _error("wrong-type", place, f"must be a list of at least one value, got {as_given(values)}")
    if isinstance(vary, list):
        for number, values in enumerate(vary):
            if not isinstance(values, dict) or not values:
                place = (*path[:3], number)
                return _error("wrong-type", place, f"must be a mapping of keys to values, got {as_given(values)}")
    return _error("wrong-type", path[:3], f"must be {_VARY}, got {as_given(vary)}")


def _error(code: str, path: Path_, message: str) -> Diagnostic:
    return Diagnostic(code, "error", path, message)


SUITES = FileKind(
    key="suite",
    model=Suite,
    folder=Path(__file__).with_name("suites"),
    error=lambda document, found: suite_error(document.name or "the suite", found),
    explain=_explain,
)
"""Suite files."""
