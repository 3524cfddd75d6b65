"""Checks for behaviors that look less far ahead than their object needs to brake."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from irsim.common.text import metres, seconds
from irsim.scenario.checks._context import Context, distinct
from irsim.scenario.messages.findings import Finding, hint
from irsim.scenario.resolve.braking import Braking, braking_of, follow_text, horizons_that_work, short_horizons
from irsim.scenario.resolve.resolved import ObjectRecord

_SEEN = {"timeHorizon": "what moves", "timeHorizonObst": "what stands"}


def check(context: Context) -> Iterator[Finding]:
    """Compare horizons with the time in which objects brake from their top speed; one finding per entry."""
    yield from distinct(_findings(context))


def _findings(context: Context) -> Iterator[Finding]:
    there = [record for record in context.resolved.objects if not record.unobstructed]
    movers, still = sum(not record.static for record in there), sum(record.static for record in there)
    for record in context.entry_objects:
        braking = None if record.static else braking_of(record)
        if braking is None:
            continue
        options: Any = record.active_behavior
        routed, inner = hasattr(options, "local"), getattr(options, "local", options)
        stands = still > 0 and not routed  # the path of `follow` keeps clear of what stands
        relevant = {"timeHorizon": movers > 1, "timeHorizonObst": stands}
        short = [key for key in short_horizons(inner, braking) if relevant[key]]
        if short:
            yield _finding(context, record, inner, braking, short, routed)


def _finding(
    context: Context, record: ObjectRecord, options: Any, braking: Braking, short: list[str], routed: bool
) -> Finding:
    key = "behavior" if record.group_behavior is None else "group_behavior"
    path = (*context.entry_path(record, key), "local") if routed else context.entry_path(record, key)
    horizon = horizons_that_work(braking)
    looks = " and ".join(f"{seconds(getattr(options, name))} ahead at {_SEEN[name]}" for name in short)
    if not routed and options.stops_in_time and short == ["timeHorizonObst"]:
        return hint(
            "brakes-too-late",
            path,
            f"{_brakes(record, braking)}, but {options.name} looks {looks}: it stops in time, perhaps instead of going "
            "round",
            fix=f"where something large stands in the way, {follow_text(record)}",
        )
    return hint(
        "brakes-too-late",
        path,
        f"{_brakes(record, braking)}, but {options.name} looks {looks}",
        fix=", ".join(f"{name}: {horizon:g}" for name in short),
    )


def _brakes(record: ObjectRecord, braking: Braking) -> str:
    return (
        f"'{record.name}' brakes from {braking.speed:g} m/s at {braking.acce:g} m/s^2 in {seconds(braking.time)} "
        f"and {metres(braking.distance)}"
    )
