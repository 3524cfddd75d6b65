"""Problems of options that a command line or a program gives, in the words of the checker of scenarios."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from pydantic import BaseModel, ValidationError

from irsim.common.text import clean
from irsim.diagnostics.diagnostic import Diagnostic, Path, format_path
from irsim.scenario.messages.translate import translate
from irsim.scenario.yaml.document import Document

__all__ = ["option_message", "option_problems"]

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
        data: What was validated.
        root: The model that has validated it.
        place: Where the options are in the data; paths of the problems start there.
        owner: What has the options, as messages call it.
    """
    where = format_path(place)
    found = []
    for item in translate(failure, data, Document(data), _MOST, root):
        one = item.diagnostic
        message = one.message
        if where:
            message = message.replace(f"'{where}'", owner).replace(f"{where}.", "")
        path = one.path[len(place) :] if one.path[: len(place)] == place else one.path
        found.append(replace(one, path=path, message=message, edit=None))
    return found


def option_message(found: Sequence[Diagnostic]) -> tuple[str, str | None]:
    """One sentence about problems, with what is allowed; and the fix of the first one that has one."""
    parts = []
    for item in found[:_MOST]:
        key = format_path(item.path) if item.path else ""
        named = not key or f"'{key}'" in item.message or (item.path and f"'{item.path[-1]}'" in item.message)
        text = item.message if named else f"{clean(key, 100)}: {item.message}"
        allowed = item.allowed if isinstance(item.allowed, str) else ", ".join(map(str, item.allowed or ()))
        if allowed and allowed not in text and len(allowed) <= _MAX_CHOICES:
            text += f" (allowed: {allowed})"
        parts.append(text)
    return "; ".join(parts), next((item.fix for item in found if item.fix), None)
