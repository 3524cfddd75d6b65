"""Collects what an audit has compared, and where the record differs."""

from __future__ import annotations

from typing import Any, Literal

from irsim.common.text import clean
from irsim.results.audit import AuditCheck, AuditFinding, NearContact

__all__ = ["MAX_LISTED", "Report"]

Status = Literal["equal", "different", "not_checked"]
MAX_LISTED = 50
"""Number of differences, and of contacts within the tolerance, that a result lists."""


class Report:
    """The results of an audit so far.

    Attributes:
        checks: The comparisons, in order.
        findings: The first differences.
        count: Number of differences.
        near: The first contacts within the tolerance.
        near_count: Number of contacts within the tolerance.
        depth: How deep two bodies may have overlapped unseen within a step [m].
    """

    def __init__(self) -> None:
        self.checks = list[AuditCheck]()
        self.findings = list[AuditFinding]()
        self.near = list[NearContact]()
        self.count = self.near_count = 0
        self.depth = 0.0
        self._open: tuple[str, int, int] = ("", 0, 0)

    def begin(self, name: str) -> None:
        """Begin a check."""
        self._open = (name, self.count, 0)

    def compared(self, number: int = 1) -> None:
        """Add to the number of values that the present check has compared."""
        name, before, done = self._open
        self._open = (name, before, done + number)

    def end(self, note: str = "") -> None:
        """End the present check."""
        name, before, done = self._open
        status: Status = "different" if self.count > before else "equal" if done else "not_checked"
        self.checks.append(
            AuditCheck(name=name, status=status, compared=done, differences=self.count - before, note=note)
        )

    def skip(self, name: str, why: str) -> None:
        """Say that something is not checked, and why."""
        self.checks.append(AuditCheck(name=name, status="not_checked", compared=0, differences=0, note=why))

    def differ(
        self,
        code: str,
        message: str,
        *,
        object: str | None = None,
        partner: str | None = None,
        step: int | None = None,
        recorded: Any = None,
        recomputed: Any = None,
        tolerance: float | None = None,
    ) -> None:
        """Add a difference; see :class:`irsim.results.audit.AuditFinding`."""
        self.count += 1
        if len(self.findings) < MAX_LISTED:
            self.findings.append(
                AuditFinding(
                    code=code,
                    object=None if object is None else clean(object, 100),
                    partner=None if partner is None else clean(partner, 100),
                    step=step,
                    recorded=recorded,
                    recomputed=recomputed,
                    tolerance=tolerance,
                    message=clean(message, 400),
                )
            )

    def is_near(self, object: str, partner: str, step: int, gap: float, note: str) -> None:
        """Add a contact that lies within the tolerance, which therefore stays undecided."""
        self.near_count += 1
        if len(self.near) < MAX_LISTED:
            self.near.append(
                NearContact(object=clean(object, 100), partner=clean(partner, 100), step=step, gap=gap, note=note)
            )
