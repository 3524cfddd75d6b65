"""Problems of suite files as diagnostics: what is wrong at which key and line, in plain words."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from irsim.benchmarks.suite import Suite
from irsim.common.arguments import as_given
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic, format_path
from irsim.diagnostics.diagnostic import Path as Path_
from irsim.diagnostics.errors import CodedError
from irsim.scenario.messages.translate import located, translate
from irsim.scenario.yaml.document import Document

__all__ = ["SuiteError", "problems_of", "suite_error"]

_MOST = 10
"""Number of problems that the message of an error lists."""
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
    texts = [_text(item, str(path), alone=len(found) == 1) for item in found[:_MOST]]
    texts += [f"and {len(found) - _MOST} more"] if len(found) > _MOST else []
    fix = found[0].fix if len(found) == 1 else None
    return SuiteError(
        f"{clean(path, 200)} is not a valid suite: {'; '.join(texts)}",
        _FIX if not fix or _is_guess(fix) else fix,
        diagnostics=found,
    )


def problems_of(failure: ValidationError, document: Document) -> list[Diagnostic]:
    """The problems of a validation, in the words of scenarios, one for each key.

    Args:
        failure: The exception of ``Suite.model_validate``.
        document: The suite as written.
    """
    data, found = document.data, dict[Path_, Diagnostic]()
    for item in failure.errors(include_url=False):
        if (special := _special(tuple(item["loc"]), data)) is not None:
            found.setdefault(special.path, special)
    for explained in translate(failure, data, document, _MOST, Suite):
        problem = explained.diagnostic
        if _special(tuple(problem.path), data) is None:
            found.setdefault(problem.path, problem)
    return [located(problem, document) for problem in found.values()]


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
