"""Notes on what the record of a long or large run omits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = ["omission_notes"]


def omission_notes(meta: Mapping[str, Any], steps: int | None = None) -> list[str]:
    """Notes on what was too large to be recorded; empty if everything was recorded.

    Args:
        meta: Content of ``run.json``.
        steps: Number of executed steps, None if the run has not ended.
    """
    whole = f"of {steps}" if steps is not None else f"of at most {meta.get('horizon')}"
    until, scans = meta.get("trace_until"), meta.get("scans_until")
    notes = []
    if until is not None and until != steps:
        notes.append(f"recorded until step {until} {whole}: size limit")
    if meta.get("scans") is False:
        notes.append("scans not recorded (too large)")
    elif scans is not None and scans not in (steps, until):
        notes.append(f"scans recorded until step {scans} {whole} (too large)")
    return notes
