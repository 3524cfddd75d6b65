"""Checks of a valid scenario, one module per family: what will not work, or not as its author expects."""

from __future__ import annotations

from irsim.scenario.checks import (
    behaviors,
    braking,
    bridges,
    crowds,
    files,
    goals,
    groups,
    kinematics,
    magnitude,
    maps,
    motion,
    names,
    outside_world,
    overlap,
    placement,
    random_placement,
    regions,
    sensors,
    shapes,
    step_size,
    symmetry,
    tunneling,
    units,
    unsupported,
    world,
    zones,
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
    zones,
    kinematics,
    shapes,
    goals,
    outside_world,
    bridges,
    placement,
    random_placement,
    overlap,
    behaviors,
    regions,
    groups,
    crowds,
    motion,
    tunneling,
    step_size,
    symmetry,
    braking,
    sensors,
    units,
    files,
    maps,
    unsupported,
)


def run_checks(context: Context) -> list[Finding]:
    """The findings of all checks."""
    return [finding for family in _FAMILIES for finding in family.check(context)]
