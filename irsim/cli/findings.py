"""Printing diagnostics, and the two things every verb does before it reads a scenario."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from irsim.cli.output import is_terminal

if TYPE_CHECKING:
    from irsim.diagnostics import Diagnostic
    from irsim.results import Finding
    from irsim.scenario.limits import Limits

__all__ = ["import_user_modules", "limits_for", "print_diagnostics", "print_findings"]


def import_user_modules(names: Sequence[str] | None) -> None:
    """Import user modules, for what they register.

    Raises:
        ImportError: Whatever went wrong in one of them.
    """
    if not names:
        return
    from irsim.api import import_modules

    for name in names:
        try:
            import_modules([name])
        except Exception as error:
            raise ImportError(f"--import {name}: {type(error).__name__}: {error}") from error


def limits_for(max_objects: int | None) -> Limits | None:
    """Limits of the loader with another number of objects; None for the defaults."""
    if max_objects is None:
        return None
    from irsim.scenario.limits import Limits

    return Limits(objects=max_objects)
