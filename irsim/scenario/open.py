"""Opens a scenario file: returns a scenario ready to build, or raises one exception that holds every problem."""

from __future__ import annotations

import os

from irsim.diagnostics.diagnostic import Diagnostic
from irsim.diagnostics.errors import NotSimulatedError, ScenarioError
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.locate import locate
from irsim.scenario.read import Reading, read
from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["open_scenario", "or_raise"]


def open_scenario(
    name: str | os.PathLike[str] | None, *, strict: bool = False, limits: Limits | None = None
) -> tuple[ResolvedScenario, list[Diagnostic]]:
    """Find, read and check a scenario file.

    Args:
        name: As the user wrote it; None for the file named like the running script.
        strict: Treat what IR-SIM 2.12 ignores as an error.
        limits: Upper bounds; a larger scenario is refused.

    Returns:
        The scenario, and the warnings and hints about it.

    Raises:
        ScenarioNotFoundError: No file has that name.
        ScenarioError: The scenario cannot be used. NotSimulatedError if its only errors are features that this version
            does not simulate yet.
    """
    return or_raise(read(locate(name), strict=strict, limits=limits or DEFAULT_LIMITS))


def or_raise(reading: Reading) -> tuple[ResolvedScenario, list[Diagnostic]]:
    """The scenario and the findings of a reading; raises if the scenario cannot be used."""
    if reading.scenario is None:
        errors = [item for item in reading.diagnostics if item.severity == "error"]
        kind = NotSimulatedError if all(e.code == "not-yet-simulated" for e in errors) else ScenarioError
        raise kind(reading.diagnostics, reading.document.text)
    return reading.scenario, reading.diagnostics
