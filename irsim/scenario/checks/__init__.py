"""Checks of a valid scenario, one module per family: what will not work, or not as its author expects.

Search for the key here first: it may be checked already. A check yields ``error``, ``warning`` or ``hint`` with the
path of the value in the file::

    path = context.entry_path(record, "vel_max")
    yield warning(
        "too-slow",
        path,
        f"'{record.name}' drives at most {record.vel_max[0]:g} m/s",
        given=record.vel_max,
        fix="vel_max: [1, 1]",
        edit=Edit("replace", path, [1.0, 1.0]),
    )

``fix`` is the advice in words. ``edit`` is the same repair for ``irsim validate --fix``, which applies it to errors
and warnings if the finding then disappears and no comment is lost; ``safe=False`` marks an edit that only the author
can choose, and ``Edit("remove", path)`` deletes a key. The path of a nested value extends the path of its entry.
The code has a title, an explanation (``irsim/diagnostics/codes/``) and an example with its repair
(``irsim/diagnostics/examples.py``). Tests have scenarios with and without the finding, and correct the headers of
files in ``tests/scenario/bad``. A new family is a module with ``check(context)``, added to ``_FAMILIES``.
"""

from __future__ import annotations

from importlib import import_module

from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding

__all__ = ["KEY_CODES", "Context", "run_checks"]

KEY_CODES = frozenset({"unknown-key", "duplicate-key"})
"""Codes whose findings point at a key rather than at its value."""

_FAMILIES = (
    "world", "magnitude", "names", "zones", "kinematics", "actuation", "shapes", "goals", "outside_world", "bridges",
    "placement", "overlap", "behaviors", "regions", "groups", "motion", "tunneling", "step_size", "symmetry", "braking",
    "sensors", "perception", "units", "files", "unsupported",
)  # fmt: skip
"""Modules of this package, in the order of their findings."""


def run_checks(context: Context) -> list[Finding]:
    """The findings of all checks."""
    families = [import_module(f"{__name__}.{name}") for name in _FAMILIES]
    return [finding for family in families for finding in family.check(context)]
