"""Formats diagnostics as text: place, message, the line with carets, allowed values and fix."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from irsim.diagnostics.codes import CODES, TOOL_CODES
from irsim.diagnostics.diagnostic import Diagnostic, by_severity, format_path

__all__ = ["error_codes", "format_diagnostic", "format_diagnostics"]

_COLORS = {"error": "\033[1;31m", "warning": "\033[1;33m", "hint": "\033[1;36m"}
_BOLD, _DIM, _RESET = "\033[1m", "\033[2m", "\033[0m"
_MAX_LINE_WIDTH = 160
"""Characters of a quoted line."""
_MAX_ALLOWED = 24
"""Allowed values that are listed."""
_CODE = r"[a-z]+(?:-[a-z]+)*"
_ERROR = re.compile(
    rf"""\berror ({_CODE})\b|^({_CODE}): |\bline \d+ ({_CODE}):|"code": ?"({_CODE})", ?"severity": ?"error\"""", re.M
)
"""An error in a report for people, in one line of a tool, in a list of errors in one line, and in JSON."""


def format_diagnostics(diagnostics: Sequence[Diagnostic], text: str | None = None, color: bool = False) -> str:
    """All findings, errors first, with a closing count.

    Args:
        diagnostics: The findings.
        text: The scenario's text, to quote lines from.
        color: Use ANSI colors.
    """
    lines = text.splitlines() if text is not None else []
    blocks = [format_diagnostic(item, lines, color) for item in by_severity(diagnostics)]
    counts = [(kind, sum(item.severity == kind for item in diagnostics)) for kind in ("error", "warning", "hint")]
    total = ", ".join(f"{n} {kind}{'s' if n != 1 else ''}" for kind, n in counts if n)
    return "\n".join([*blocks, total]) if blocks else ""


def format_diagnostic(item: Diagnostic, lines: Sequence[str] = (), color: bool = False) -> str:
    """One finding.

    Args:
        item: The finding.
        lines: The lines of the text it is about; empty without text.
        color: Use ANSI colors.
    """
    paint = _painter(color)
    place = _printable(":".join(str(part) for part in (item.file, item.line, item.column) if part is not None))
    head = f"{paint(item.severity, _COLORS[item.severity])} {item.code}  {_printable(format_path(item.path))}"
    out = [f"{paint(place, _BOLD)}  {head}" if place else head]
    if item.line is not None and 1 <= item.line <= len(lines):
        out += _quote_line(item, lines[item.line - 1], paint)
    else:
        out += [f"  {_printable(line)}" for line in item.message.split("\n")]
    advice = []
    if item.allowed:
        advice.append("allowed: " + _allowed_text(item.allowed) + _suggestion(item))
    if item.fix:
        advice.append("fix: " + item.fix)
    if advice:
        out.append("  " + _printable("   ".join(advice)))
    return "\n".join(out)


def _quote_line(item: Diagnostic, line: str, paint: Any) -> list[str]:
    """The line of the text, and carets under the part that the finding is about."""
    number = str(item.line)
    column = max(item.column or 1, 1)
    start = max(0, min(column - 1 - _MAX_LINE_WIDTH // 2, len(line) - _MAX_LINE_WIDTH))
    shown = _printable(line[start : start + _MAX_LINE_WIDTH])
    offset = column - 1 - start
    length = max(1, min(item.length, len(shown) - offset)) if offset < len(shown) else 1
    gutter = " " * (len(number) + 3)
    carets = paint("^" * length, _COLORS[item.severity])
    return [
        f"{paint(f'   {number} | ', _DIM)}{shown}",
        f"{gutter}{paint(' | ', _DIM)}{' ' * offset}{carets} {_printable(item.message)}",
    ]


def _suggestion(item: Diagnostic) -> str:
    """A question with the word that was probably meant; empty if no word is likely."""
    edit = item.edit
    if edit is None or not isinstance(edit.value, str) or isinstance(item.allowed, str):
        return ""
    return f". Did you mean '{edit.value}'?"


def _painter(color: bool) -> Any:
    return (lambda text, style: f"{style}{text}{_RESET}") if color else (lambda text, style: text)


def _printable(text: str) -> str:
    """The text without control characters, which could mislead a terminal."""
    return "".join(character if character.isprintable() else " " for character in text)


def _allowed_text(allowed: Sequence[str] | str) -> str:
    if isinstance(allowed, str):
        return allowed
    shown = ", ".join(str(item) for item in allowed[:_MAX_ALLOWED])
    return shown + (f", and {len(allowed) - _MAX_ALLOWED} more" if len(allowed) > _MAX_ALLOWED else "")


def error_codes(text: str) -> list[str]:
    """The codes of the errors that a report or an answer of a tool names, each once."""
    named = (next(filter(None, match.groups())) for match in _ERROR.finditer(text))
    return list(dict.fromkeys(code for code in named if code in CODES or code in TOOL_CODES))
