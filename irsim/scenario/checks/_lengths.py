"""Lists of numbers that a drive takes, one for each of its controls."""

from __future__ import annotations

from typing import Any

from irsim.diagnostics.diagnostic import Edit, Path
from irsim.scenario.messages.findings import Finding, error
from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["wrong_length"]


def wrong_length(
    record: ObjectRecord,
    path: Path,
    values: list[float],
    *,
    or_number: bool = False,
    written: str | None = None,
    edit: Edit | None = None,
    carry_on: Edit | None = None,
) -> Finding:
    """A list that has another length than its drive has controls.

    Args:
        record: The object, which has a drive.
        path: Path of the list.
        values: The list.
        or_number: Whether one number for all controls is allowed, too.
        written: The value with which ``edit`` replaces the list.
        edit: A repair; None without one.
        carry_on: The edit with which reading goes on.
    """
    drive: Any = record.kinematics
    key, count = path[-1], record.vel_dim
    rows = f" ({', '.join(drive.control_rows)})" if count == len(drive.control_rows) else ""
    must = f"be one number, or a list of {count}{rows}" if or_number else f"have {count} numbers{rows}"
    return error(
        "wrong-length",
        path,
        f"'{key}' of '{drive.name}' must {must}, got {len(values)}",
        given=values,
        allowed=f"{'a number, or ' if or_number else ''}{count} numbers{rows}",
        fix=f"{key}: {written}" if edit else None,
        edit=edit,
        carry_on=carry_on,
    )
