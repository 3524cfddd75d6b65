"""Reads a case file: its expressions are filled in, and everything that is wrong with it is said at once."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from irsim.diagnostics.diagnostic import Diagnostic
from irsim.diagnostics.diagnostic import Path as Path_
from irsim.diagnostics.errors import ScenarioError
from irsim.scenario.file_kind import FileKind
from irsim.scenario.messages.translate import located, translate
from irsim.scenario.model.lookup import at
from irsim.scenario.yaml.document import Document
from irsim_evals.cases.expressions import substitute, values_of
from irsim_evals.cases.model import Case

__all__ = ["CASES", "CaseError", "folder", "read_case"]

_MAX_PROBLEMS = 200
"""Largest number of problems of a case that are listed."""
_AS_WRITTEN = ("parameters", "let")
"""Keys in whose values no expression is replaced."""


class CaseError(ScenarioError):
    """A case file that cannot be used, with every problem found."""


def read_case(document: Document, rng: random.Random | None = None) -> tuple[Case, dict[str, Any]]:
    """Read a case, and draw the values of an instance of it.

    Args:
        document: The file.
        rng: Draws the values; None for the case as published.

    Raises:
        CaseError: Something is wrong with the file.
    """
    data: Any = document.data
    problems: list[Diagnostic] = []
    values: dict[str, Any] = {}
    own: Any = ()
    if isinstance(data, Mapping):
        values = values_of(data, rng, problems)
        language = str(data.get("language", "en"))
        own = data.get("select") or ()
        data = {
            key: (value or {}) if key in _AS_WRITTEN else substitute(value, values, language, problems, (str(key),))
            for key, value in data.items()
        }
        name = Path(document.path).stem if document.path is not None else data.get("id")
        if isinstance(data.get("id"), str) and data["id"] != name:
            message = f"the file is called {name}, and its id is {data['id']!r}"
            problems.append(Diagnostic("invalid-value", "error", ("id",), message, fix=f"id: {name}"))
    problems = [*document.problems, *(located(item, document) for item in problems)]
    context = {"selections": list(own), "files": str(data.get("files") if isinstance(data, Mapping) else "")}
    return CASES.read(replace(document, data=data, problems=problems), context), values


def _explain(failure: ValidationError, document: Document, model: type[BaseModel]) -> list[Diagnostic]:
    """The problems of a validation, one for each place."""
    findings = translate(failure, document.data, document, _MAX_PROBLEMS, model, each=True)
    wrong = [item.diagnostic for item in findings]
    placed = [_in_file(item, document.data) for item in wrong]
    return list({item.path: item for item in reversed(placed)}.values())[::-1]


def _in_file(item: Diagnostic, data: Any) -> Diagnostic:
    """A problem in the words of the file: a short list lacks an item, and a key may be an unknown one."""
    path, last = _place(item.path, data), item.path[-1] if item.path else ""
    if item.code == "missing-key" and isinstance(last, int):
        return replace(item, code="wrong-length", path=path[:-1], message=f"item {last + 1} is missing", fix=None)
    if item.code == "unknown-key" and item.fix == "remove it" and path[-3:-2] == ("assert",):
        item = replace(item, fix="irsim-evals predicates says what an assertion can be")
    return replace(item, path=path, code="unknown-key" if last == "[key]" else item.code, edit=None)


def _place(path: Path_, data: Any) -> Path_:
    """A place in the file: without marks of pydantic, and without keys that the file may leave out."""
    place: Path_ = ()
    for part in path:
        around = at(data, place)
        there = part in around if isinstance(around, Mapping) else isinstance(around, list) and isinstance(part, int)
        if there or (part == path[-1] and isinstance(around, Mapping) and str(part).isidentifier()):
            place = (*place, part)
    return place


def _error(document: Document, problems: Sequence[Diagnostic]) -> CaseError:
    """The error about a file; a value that could not be computed is not wrong in a second way."""
    known = {item.path for item in problems if item.message.startswith("it cannot be computed")}
    kept = [item for item in problems if item.path not in known or item.message.startswith("it cannot be computed")]
    return CaseError([replace(item, file=item.file or document.name) for item in kept], document.text)


def folder(kind: str) -> Path:
    """The folder ``cases`` or ``golds``: beside this package in a checkout, else in the installed data."""
    here = Path(__file__).resolve().parents[2] / kind
    return here if here.is_dir() else Path(__file__).resolve().parents[1] / "data" / kind


CASES = FileKind(key="prompt", model=Case, folder=folder("cases"), error=_error, explain=_explain)
"""Case files."""
