"""YAML files beside scenarios, such as settings and maps, as plain data or one error."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from irsim.common.records import ContentError, read_text
from irsim.common.yaml.compose import compose
from irsim.common.yaml.limits import YamlLimits

__all__ = ["SMALL", "read_plain_yaml", "read_value"]

SMALL = YamlLimits(bytes=1024 * 1024, events=100_000, expansion=100_000, aliases=10_000, depth=32)
"""Limits of files beside scenarios."""


def read_plain_yaml(source: str | bytes | Path, limits: YamlLimits = SMALL) -> Any:
    """The data of one YAML document; None if it is empty.

    A key that is given twice has its last value, as with PyYAML.

    Args:
        source: The text, its bytes, or the file.
        limits: Upper bounds on it.

    Raises:
        ContentError: The file cannot be read, or is not one document of plain data within the limits.
    """
    text = source if isinstance(source, str) else read_text(source, limits.bytes)
    if len(text) > limits.bytes:
        raise ContentError("it is too large", f"{len(text):,} characters", f"up to {limits.bytes:,}")
    composed = compose(text, limits)
    if not composed.fatal:
        return composed.data
    problem = next(problem for problem in composed.problems if problem.severity == "error" and not problem.tolerated)
    if problem.code == "empty-document":
        return None
    where = "" if problem.line is None else f" (line {problem.line}, column {problem.column})"
    raise ContentError(f"{problem.message}{where}", fix=problem.fix)


def read_value(text: str) -> Any:
    """The value of an argument ``KEY=VALUE``: as YAML reads it, and the text itself where that fails."""
    try:
        return read_plain_yaml(text)
    except ContentError:
        return text
