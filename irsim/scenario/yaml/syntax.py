"""Turns an exception of the YAML parser into a diagnostic."""

from __future__ import annotations

import yaml

from irsim.diagnostics.diagnostic import Diagnostic, Path

__all__ = ["syntax_problem"]


def syntax_problem(error: yaml.YAMLError, text: str, path: Path) -> Diagnostic:
    """The diagnostic for a parser's exception.

    Args:
        error: The exception.
        text: The text that was read.
        path: Path of the value that was being read.
    """
    line = column = 1
    message = " ".join(str(error).split())
    if isinstance(error, yaml.MarkedYAMLError):
        mark = error.problem_mark or error.context_mark
        if mark is not None:
            line, column = mark.line + 1, mark.column + 1
        message = ", ".join(part for part in (error.context, error.problem) if part)
    elif isinstance(error, yaml.reader.ReaderError):
        position = error.position if isinstance(error.position, int) else 0
        before = text[:position]
        line, column = before.count("\n") + 1, position - before.rfind("\n")
        message = "a character that YAML does not allow"
    if "exceeded maximum nesting depth" in message:  # PyYAML has a limit of its own since version 6.0.4
        return Diagnostic("too-deep", "error", path, "nested too deeply", line=line, column=column)
    fix = None
    if "cannot start any token" in message and _character(text, line, column) == "\t":
        message, fix = "a tab is used for indentation", "indent with spaces"
    elif "cannot start any token" in message and _character(text, line, column) == "`":
        message, fix = "a Markdown fence is not part of the YAML", "leave out the lines with ```"
    return Diagnostic("yaml-syntax", "error", path, message, line=line, column=column, fix=fix)


def _character(text: str, line: int, column: int) -> str:
    lines = text.splitlines()
    return lines[line - 1][column - 1 : column] if 0 < line <= len(lines) else ""
