"""``overlap_free``: in how many seeds nothing overlaps at the start."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.diagnostics.errors import PlacementError
from irsim_evals.grader.matching import Quantity
from irsim_evals.grader.predicates._base import Observation, SeedsPredicate, register
from irsim_evals.grader.sanity import overlaps

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material


@register("overlap_free")
class OverlapFree(SeedsPredicate):
    """Nothing overlaps at the start in a share of the seeds; a seed without a free place counts as an overlap."""

    stage = "sane"

    seeds: int = 20
    """Number of seeds, from 0 on."""
    share: Quantity
    """Least share of them."""

    def observe(self, material: Material) -> Observation:
        """Count the seeds."""
        bad = []
        for seed in range(self.seeds):
            try:
                if overlaps(material.scene(seed)):
                    bad.append(seed)
            except PlacementError:
                bad.append(seed)
        free = self.seeds - len(bad)
        return Observation(
            free >= self.share * self.seeds - 1e-9,
            f"no overlap in {self.share:.0%} of {self.seeds} seeds",
            f"{free} of {self.seeds}",
            seed=bad[0] if bad else None,
        )
