"""The map: files that are missing or no pictures, maps without walls or without room."""

from __future__ import annotations

from collections.abc import Iterator

from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding


def check(context: Context) -> Iterator[Finding]:
    """What loading it found."""
    yield from context.map_findings
