"""Checks that plug-in authors call from their own tests: see :mod:`irsim.testing.conformance`."""

from irsim.testing.conformance import (
    check_declaration_order,
    check_defaults,
    check_documented,
    check_finite,
    check_kernel,
    check_same_seed,
    check_turned_world,
    check_units,
    scenario_with,
    simulate,
)

__all__ = [
    "check_declaration_order",
    "check_defaults",
    "check_documented",
    "check_finite",
    "check_kernel",
    "check_same_seed",
    "check_turned_world",
    "check_units",
    "scenario_with",
    "simulate",
]
