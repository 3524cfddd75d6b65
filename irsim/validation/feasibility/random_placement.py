"""Random placement tried with several seeds: with how many of them all objects find a free place."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from irsim.common.text import listed
from irsim.scenario.checks import Context
from irsim.scenario.messages.findings import Finding, error, warning
from irsim.scenario.resolve.resolved import Placement
from irsim.validation.feasibility.scenes import Drawn

__all__ = ["check"]

_MAX_SEEDS = 5
"""Number of seeds that a message names."""


def check(context: Context, drawn: Drawn) -> Iterator[Finding]:
    """Report the entry whose objects most often find no free place."""
    if not drawn.failed:
        return
    entries = Counter(context.resolved.objects[index].path for index in drawn.failed.values())
    path = min(entries, key=lambda key: (-entries[key], key))
    placement = next((p for p in context.resolved.placements if p.path == path), None)
    if placement is None:
        return
    failed, tried = len(drawn.failed), drawn.tried
    seeds = listed([str(seed) for seed in sorted(drawn.failed)], _MAX_SEEDS)
    what = f"with {failed} of {tried} seeds, not all objects find a free place ({seeds})"
    place, fix = _words(placement)
    where = (*path, "distribution")
    if failed == tried or drawn.own in drawn.failed:
        own = (
            f", among them the scenario's own seed {drawn.own}" if drawn.own in drawn.failed and failed < tried else ""
        )
        what = f"with none of {tried} seeds do all objects find a free place" if failed == tried else what
        yield error("placement-crowded", where, f"{what}{own}; {place}", given=len(placement.objects), fix=fix)
    else:
        yield warning("placement-tight", where, f"{what}; {place}", given=len(placement.objects), fix=fix)


def _words(placement: Placement) -> tuple[str, str]:
    """The request of the entry, and what to change."""
    count = len(placement.objects)
    if placement.distribution != "random":
        place = f"this entry puts {count} objects into {placement.room}, clear of all others"
        now = placement.options[placement.distance_key]
        return (
            place,
            f"fewer or smaller objects, a smaller {placement.distance_key} (now {now:g} m), or {placement.widen}",
        )
    width, height = (placement.range_high[i] - placement.range_low[i] for i in range(2))
    place = f"this entry puts {count} objects into {width:g} m × {height:g} m, clear of all others"
    kept = placement.further_keys
    also = f" or {' or '.join(kept)}" if kept else ""
    return (
        place + (f", under {' and '.join(kept)}" if kept else ""),
        f"fewer or smaller objects, a smaller min_distance (now {placement.min_distance:g} m){also}, or a larger range",
    )
