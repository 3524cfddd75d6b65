"""Problems of suite files as diagnostics: what is wrong at which key and line, in plain words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, get_args

from pydantic import BaseModel

from irsim.benchmarks.suite import Seeds, Suite, SuiteScenario
from irsim.common.arguments import as_given
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic, format_path, nearest
from irsim.diagnostics.errors import CodedError
from irsim.scenario.perturbation import Perturbation
from irsim.scenario.yaml.document import Document

__all__ = ["SuiteError", "located", "problems_of", "suite_error"]

_MOST = 10
"""Number of problems that the message of an error lists."""
_FIX = "irsim describe suites lists the keys of a suite file and has an example"
_KEYS = ("unknown-key", "conflicting-keys", "duplicate-key")
"""Codes of problems of a key rather than of its value."""
_NAME = "a letter, then up to 63 letters, digits, dots, hyphens and underscores"
_VARY = "a mapping of each key to a list of values, or a list of mappings, each of which is one scenario"
_POLICY = "the name of a behavior, or a mapping such as {name: orca, timeHorizon: 2}"
_EXPECTED = {
    "int": "a whole number",
    "float": "a number",
    "bool": "true or false",
    "string": "text",
    "list": "a list",
    "dict": "a mapping (key: value)",
    "mapping": "a mapping (key: value)",
    "model": "a mapping (key: value)",
}
"""Kind of error without its last word → what is expected."""
_BOUNDS = {"greater_than_equal": ("ge", "at least"), "less_than_equal": ("le", "at most"), "less_than": ("lt", "below")}


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


def located(item: Diagnostic, document: Document) -> Diagnostic:
    """A problem with its position in the suite file, if that has a text."""
    if item.line is not None:
        return item
    mark = document.mark((*document.prefix, *item.path), key=item.code in _KEYS)
    if mark is None:
        return replace(item, file=document.name)
    return replace(item, line=mark.line, column=mark.column, length=mark.length, file=document.name)


def problems_of(errors: Sequence[Any], data: Any) -> list[Diagnostic]:
    """The problems that pydantic lists, in plain words, one for each key.

    Args:
        errors: Its list of errors.
        data: The suite as written.
    """
    found: dict[tuple[str | int, ...], Diagnostic] = {}
    for item in errors:
        problem = _problem(item, data)
        found.setdefault(problem.path, problem)
    return list(found.values())


def _text(item: Diagnostic, path: str, *, alone: bool) -> str:
    """A problem as part of a sentence."""
    place = [] if item.file in (None, path) else [clean(item.file, 100)]
    place += [] if item.line is None else [f"line {item.line}"]
    text = item.message
    if not text.startswith("scenario ") and item.path:
        text = f"{clean(format_path(item.path), 100)}: {text}"
    if item.fix and _is_guess(item.fix):
        text += f", {item.fix}"
    elif item.fix and not alone:
        text += f" ({item.fix})"
    return f"{', '.join(place)}: {text}" if place else text


def _is_guess(fix: str) -> bool:
    return fix.startswith("did you mean")


def _problem(item: Any, data: Any) -> Diagnostic:
    path, kind, context = tuple(item["loc"]), str(item["type"]), item.get("ctx") or {}
    special = _special(path, data)
    if special is not None:
        return special
    value = item.get("input")
    if path[-1:] == ("[key]",):
        path, value = path[:-1], path[-2]
    if kind == "extra_forbidden":
        near = nearest(str(path[-1]), _keys_at(path[:-1]))
        return _error("unknown-key", path, "there is no such key", f"did you mean {near}?" if near else None)
    if kind == "missing":
        return _error("missing-key", path, "this key is missing")
    if kind == "value_error":
        return _error("invalid-value", path, clean(str(item["msg"]).removeprefix("Value error, "), 200))
    given = as_given(value)
    if kind == "literal_error":
        words = _choices(path)
        near = nearest(str(value), words)
        fix = f"did you mean {near}?" if near else f"choose from {', '.join(words)}"
        return _error("unknown-value", path, f"must be one of {', '.join(words)}, got {given}", fix, words)
    if kind == "string_pattern_mismatch":
        return _error("invalid-value", path, f"must be {_NAME}, got {given}")
    if kind in _BOUNDS:
        key, words_of = _BOUNDS[kind]
        return _error("out-of-range", path, f"must be {words_of} {context.get(key)}, got {given}")
    if kind == "too_short":
        return _error("wrong-length", path, "must not be empty")
    if kind in ("string_too_short", "string_too_long"):
        return _error("wrong-length", path, "must have 1 to 100 characters")
    expected = _EXPECTED.get(kind.split("_")[0])
    if expected is None:
        return _error("invalid-value", path, f"has an invalid value: {given}")
    return _error("wrong-type", path, f"must be {expected}, got {given}")


def _special(path: tuple[str | int, ...], data: Any) -> Diagnostic | None:
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


def _error(
    code: str, path: tuple[str | int, ...], message: str, fix: str | None = None, allowed: Sequence[str] | None = None
) -> Diagnostic:
    return Diagnostic(code, "error", path, message, fix=fix, allowed=allowed)


def _keys_at(place: tuple[str | int, ...]) -> list[str]:
    """The keys of the mapping at a place of a suite file."""
    model: type[BaseModel] = Suite
    if "perturb" in place:
        model = Perturbation
    elif place[:1] == ("seeds",):
        model = Seeds
    elif place[:1] == ("scenarios",):
        model = SuiteScenario
    return list(model.model_fields)


def _choices(path: tuple[str | int, ...]) -> list[str]:
    """The words that a key allows."""
    annotation = Suite.model_fields[str(path[0])].annotation
    found: list[str] = []

    def collect(part: Any) -> None:
        if getattr(part, "__origin__", None) is Literal:
            found.extend(map(str, get_args(part)))
        else:
            for inner in get_args(part):
                collect(inner)

    collect(annotation)
    return found
