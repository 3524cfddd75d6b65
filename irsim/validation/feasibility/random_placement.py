"""Random placement tried with several seeds: with how many of them all objects find a free place."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from irsim.scenario.checks import Context
from irsim.scenario.messages.findings import Finding, error, warning
from irsim.validation.feasibility.scenes import Drawn

__all__ = ["check"]


def check(context: Context, drawn: Drawn) -> Iterator[Finding]:
    """Report the entry whose objects most often find no free place."""
    if not drawn.failed:
        return
    entries = Counter(context.resolved.objects[index].path for index in drawn.failed.values())
    path = min(entries, key=lambda key: (-entries[key], key))
    placement = next((p for p in context.resolved.placements if p.path == path), None)
    if placement is None:
        return
    width, height = (placement.range_high[i] - placement.range_low[i] for i in range(2))
    failed, tried = len(drawn.failed), drawn.tried
    what = f"with {failed} of {tried} seeds, not all objects find a free place"
    place = f"this entry puts {len(placement.objects)} objects into {width:g} m × {height:g} m, clear of all others"
    fix = f"fewer or smaller objects, a smaller min_distance (now {placement.min_distance:g} m), or a larger range"
    where = (*path, "distribution")
    if failed == tried or drawn.own in drawn.failed:
        own = (
            f", among them the scenario's own seed {drawn.own}" if drawn.own in drawn.failed and failed < tried else ""
        )
        what = f"with none of {tried} seeds do all objects find a free place" if failed == tried else what
        yield error("placement-crowded", where, f"{what}{own}; {place}", given=len(placement.objects), fix=fix)
    else:
        yield warning("placement-tight", where, f"{what}; {place}", given=len(placement.objects), fix=fix)
