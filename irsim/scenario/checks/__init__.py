"""Checks of a valid scenario: what would not work, or work otherwise than its author expects. One file per family."""

from __future__ import annotations

from irsim.scenario.checks import (
    behaviors,
    files,
    goals,
    groups,
    kinematics,
    magnitude,
    maps,
    motion,
    names,
    overlap,
    placement,
    sensors,
    shapes,
    units,
    world,
)
from irsim.scenario.checks import (
    random_placement as crowding,
)
from irsim.scenario.checks import (
    tunneling as jumps,
)
from irsim.scenario.checks import (
    unsupported as simulated,
)
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding

__all__ = ["KEY_CODES", "Context", "run_checks"]

KEY_CODES = frozenset({"unknown-key", "duplicate-key"})
"""Codes whose findings point at a key rather than at its value."""

_FAMILIES = (
    world,
    magnitude,
    names,
    kinematics,
    shapes,
    goals,
    placement,
    crowding,
    overlap,
    behaviors,
    groups,
    motion,
    jumps,
    sensors,
    units,
    files,
    maps,
    simulated,
)


def run_checks(context: Context) -> list[Finding]:
    """The findings of every family."""
    return [finding for family in _FAMILIES for finding in family.check(context)]
