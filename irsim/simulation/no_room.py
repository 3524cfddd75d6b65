"""The finding about an object for which a scene has no room."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.diagnostics.diagnostic import Diagnostic
from irsim.simulation.build import PLACEMENT_ATTEMPTS

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ObjectRecord, Placement, ResolvedScenario

__all__ = ["no_room"]


def no_room(scenario: ResolvedScenario, index: int, seed: int) -> Diagnostic:
    """Return the finding that an object does not fit into the scene of a seed.

    Args:
        scenario: The scenario.
        index: Index of the object.
        seed: Seed of the scene.
    """
    record = scenario.objects[index]
    placement = next((item for item in scenario.placements if record.id in item.objects), None)
    if placement is None:
        return _near_its_start(scenario, record, seed)
    return _in_its_range(scenario, record, placement, seed)


def _in_its_range(scenario: ResolvedScenario, record: ObjectRecord, placement: Placement, seed: int) -> Diagnostic:
    kept = placement.further_keys
    lower = [f"`{key}`" for key in ("number", placement.distance_key, *kept)]
    also = f", and must hold {' and '.join(kept)}" if kept else ""
    return Diagnostic(
        code="placement-crowded",
        severity="error",
        path=(*record.path, "distribution"),
        message=(
            f"no room for {record.name!r} with seed {seed}: {len(placement.objects)} objects of this entry "
            f"share {placement.room}{also}"
        ),
        given=len(placement.objects),
        fix=f"lower {', '.join(lower[:-1])} or {lower[-1]}, make the shapes smaller, or {placement.widen}",
        file=scenario.source,
    )


def _near_its_start(scenario: ResolvedScenario, record: ObjectRecord, seed: int) -> Diagnostic:
    return Diagnostic(
        code="placement-crowded",
        severity="error",
        path=record.path,
        message=(
            f"no room for {record.name!r} with seed {seed}: in {PLACEMENT_ATTEMPTS:,} draws within its spread it "
            "overlaps another object, or starts behind a wall or outside the world"
        ),
        given=list(record.state[:3]),
        fix="lower `position` or `heading` of perturb, or leave this object out of its `objects`",
        file=scenario.source,
    )
