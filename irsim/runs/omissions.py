"""What a record lacks, in words: of a long or large run not everything is kept."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = ["lacking"]


def lacking(meta: Mapping[str, Any], steps: int | None = None) -> list[str]:
    """What was not kept because there was too much of it; empty if everything was.

    Args:
        meta: What ``run.json`` says.
        steps: Executed steps, if the run has ended.
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
