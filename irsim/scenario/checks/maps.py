"""Checks the map: missing or unreadable files, maps without occupied or without free cells."""

from __future__ import annotations

from collections.abc import Iterator

from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding


def check(context: Context) -> Iterator[Finding]:
    """The findings made while loading the map."""
    yield from context.map_findings
