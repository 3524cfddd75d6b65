"""Turns the errors of a pydantic validation into findings: of a file, or of options that a program gives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

from pydantic import BaseModel, ValidationError

from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic, Path, format_path
from irsim.options.vectors import UNION_TAGS
from irsim.scenario.messages.findings import Finding
from irsim.scenario.messages.pydantic_errors import Explainer
from irsim.scenario.model.scenario import Scenario
from irsim.scenario.yaml.document import Document

__all__ = ["Special", "located", "option_message", "option_problems", "translate"]

Special: TypeAlias = Callable[[Path], Diagnostic | None]
"""Explains the errors at some places of a document in words of its own; None for all other places."""
_OF_KEYS = ("unknown-key", "missing-key", "conflicting-keys", "duplicate-key")
"""Codes of problems of a key rather than of its value."""


def translate(
    failure: ValidationError,
    data: Any,
    document: Document,
    most: int,
    root: type[BaseModel] = Scenario,
    special: Special = lambda _: None,
    each: bool = False,
) -> list[Finding]:
    """Findings for the errors of a validation, at most ``most`` of them.

    Args:
        failure: The exception of ``model_validate`` of the root.
        data: The data that were validated.
        document: The document of the data, to look up how values were written.
        most: Largest number of findings.
        root: Model of the whole document.
        special: Explains values that may have several forms, for each of which pydantic lists an error.
        each: Name each element of a list that is wrong, instead of the first and their number.
    """
    findings: dict[tuple[str, Path], list[Finding]] = {}
    for item in failure.errors(include_url=False):
        if (own := special(item["loc"])) is not None:
            if len(findings) <= most:
                findings["", own.path] = [Finding(own)]
            continue
        path = _path(item["loc"])
        siblings = findings.setdefault((item["type"], path if each else _list_path(path)), [])
        if siblings and _list_path(path) != path:
            siblings.append(siblings[0])  # only counted
        elif len(findings) <= most:
            siblings.append(Explainer(path, item, data, document, root).finding())
    return [_with_count(siblings) for siblings in findings.values() if siblings]


def located(item: Diagnostic, document: Document) -> Diagnostic:
    """A problem with its position in its file, if that has a text."""
    mark = document.mark((*document.prefix, *item.path), key=item.code in _OF_KEYS)
    if mark is None or item.line is not None:
        return replace(item, file=item.file or document.name)
    return replace(item, line=mark.line, column=mark.column, length=mark.length, file=document.name)


def _path(location: tuple[Any, ...]) -> Path:
    """A pydantic location without the tags of unions."""
    return tuple(part for part in location if part not in UNION_TAGS)


def _list_path(path: Path) -> Path:
    """The list that an element of a vector or of a list of vectors belongs to; other paths as they are."""
    end = len(path)
    while end > 2 and isinstance(path[end - 1], int):
        end -= 1
    return path[:end]


def _with_count(findings: list[Finding]) -> Finding:
    first, more = findings[0], len(findings) - 1
    if not more:
        return first
    message = f"{first.diagnostic.message} (and {more} more in this list)"
    return replace(first, diagnostic=replace(first.diagnostic, message=message))


_MOST = 10
"""Number of problems that a message lists."""
_MAX_CHOICES = 200
"""Longest list of allowed values in a message [characters]."""


def option_problems(
    failure: ValidationError, data: Any, root: type[BaseModel], place: Path = (), owner: str = ""
) -> list[Diagnostic]:
    """The problems of options.

    Args:
        failure: The exception of ``model_validate`` of the root.
        data: The validated data.
        root: The model that has validated it.
        place: Where the options are in the data; paths of the problems start there.
        owner: Owner of the options, as messages call it.
    """
    where = format_path(place)
    diagnostics = []
    for item in translate(failure, data, Document(data), _MOST, root):
        one = item.diagnostic
        message = one.message
        if where:
            message = message.replace(f"'{where}'", owner).replace(f"{where}.", "")
        path = one.path[len(place) :] if one.path[: len(place)] == place else one.path
        diagnostics.append(replace(one, path=path, message=message, edit=None))
    return diagnostics


def option_message(diagnostics: Sequence[Diagnostic]) -> tuple[str, str | None]:
    """One sentence about problems, with what is allowed; and the fix of the first one that has one."""
    parts = []
    for item in diagnostics[:_MOST]:
        key = format_path(item.path) if item.path else ""
        named = not key or f"'{key}'" in item.message or (item.path and f"'{item.path[-1]}'" in item.message)
        text = item.message if named else f"{clean(key, 100)}: {item.message}"
        allowed = item.allowed if isinstance(item.allowed, str) else ", ".join(map(str, item.allowed or ()))
        if allowed and allowed not in text and len(allowed) <= _MAX_CHOICES:
            text += f" (allowed: {allowed})"
        parts.append(text)
    return "; ".join(parts), next((item.fix for item in diagnostics if item.fix), None)
