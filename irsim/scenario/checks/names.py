"""Checks names: whether they are unique, and known where they are referred to."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

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
    yield from _check_bridges(context, set(first))


def _check_bridges(context: Context, names: set[str]) -> Iterator[Finding]:
    """Report objects that bridges name and that do not exist."""
    robots = {record.name for record in context.resolved.robots()}
    bridges: Sequence[Any] = context.resolved.bridges
    for number, bridge in enumerate(bridges):
        for key in getattr(bridge, "objects", ()):
            known = robots if key in bridge.robots_only else names
            given = getattr(bridge, key) or ()
            for place, name in enumerate(given):
                if name in known:
                    continue
                near = nearest(name, known)
                yield error(
                    "unknown-object",
                    ("bridges", number, key, name if isinstance(given, dict) else place),
                    f"no {'robot' if known is robots else 'object'} is called '{name}'",
                    given=name,
                    allowed=sorted(known)[:20],
                    fix=None if near is None else f"write {near}",
                )
