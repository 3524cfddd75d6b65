"""From a file name to a scenario ready to build, or an exception that holds every problem."""

from __future__ import annotations

import os

from irsim.diagnostics.diagnostic import Diagnostic
from irsim.diagnostics.errors import NotSimulatedError, ScenarioError
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.locate import locate
from irsim.scenario.read import Reading, read
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.scenario.yaml.document import Document

__all__ = ["open_scenario", "or_raise"]


def open_scenario(
    name: str | os.PathLike[str] | None, *, strict: bool = False, limits: Limits | None = None
) -> tuple[ResolvedScenario, list[Diagnostic]]:
    """Find, read and check a scenario file.

    Args:
        name: As the user wrote it; None for the file named like the running script.
        strict: What IR-SIM would ignore is an error.
        limits: What to refuse.

    Returns:
        The scenario, and warnings and hints about it.

    Raises:
        ScenarioNotFoundError: There is none of that name.
        ScenarioError: It cannot be used; NotSimulatedError when that is only for features still to come.
    """
    return or_raise(read(locate(name), strict=strict, limits=limits or DEFAULT_LIMITS))


def or_raise(reading: Reading) -> tuple[ResolvedScenario, list[Diagnostic]]:
    """The scenario of a reading and what was found, or the exception for it."""
    if reading.scenario is None:
        errors = [item for item in reading.diagnostics if item.severity == "error"]
        kind = NotSimulatedError if all(e.code == "not-yet-simulated" for e in errors) else ScenarioError
        raise kind(reading.diagnostics, _text(reading.document))
    return reading.scenario, reading.diagnostics


def _text(document: Document) -> str | None:
    return document.text
