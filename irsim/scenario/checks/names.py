"""Checks names: whether they are unique, and known where they are referred to."""

from __future__ import annotations

from collections.abc import Iterator

from irsim.diagnostics.diagnostic import Edit, is_slip_of, nearest
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, error


def check(context: Context) -> Iterator[Finding]:
    """Report duplicate names, and a viewpoint that names no object."""
    first: dict[str, int] = {}
    reported: set[tuple[object, ...]] = set()
    for record in context.resolved.objects:
        other = first.setdefault(record.name, record.id)
        if other == record.id:
            continue
        path = context.entry_path(record, "name")
        if path in reported:
            continue
        reported.add(path)
        yield error(
            "duplicate-name",
            path,
            f"the name '{record.name}' is already taken by object {other}",
            given=record.name,
            fix="give each object a name of its own (a list with one name per object), or no name",
        )
    viewpoint = context.scenario.world.plot.viewpoint
    if isinstance(viewpoint, str) and viewpoint not in first:
        near = nearest(viewpoint, first)
        path = ("world", "plot", "viewpoint")
        yield error(
            "unknown-object",
            path,
            f"no object is called '{viewpoint}'",
            given=viewpoint,
            allowed=sorted(first)[:20],
            fix=f"viewpoint: {near}" if near else None,
            edit=Edit("replace", path, near, safe=is_slip_of(viewpoint, near)) if near else None,
            carry_on=Edit("remove", path),
        )
