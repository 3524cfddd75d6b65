"""``fill``: the share of the world that its map occupies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("fill")
class Fill(ScenePredicate):
    """The map of the world: its kind, its cells, and the share of them that is occupied."""

    kind: Match | None = None
    """Accepted names of the map: ``perlin``, ``image``, ``ros``."""
    cell: Match | None = None
    """Accepted sizes of a cell [m]."""
    share: Match | None = None
    """Accepted shares of occupied cells."""
    seed: Match | None = None
    """Accepted seeds of the map."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Look at the cells."""
        options, grid = scene.world.obstacle_map, scene.env.scenario.grid
        seen = {
            "kind": None if options is None else getattr(options, "name", "image"),
            "cell": None if grid is None else max(grid.cell),
            "share": None if grid is None else grid.occupied / (grid.size[0] * grid.size[1]),
            "seed": getattr(options, "seed", None),
        }
        wanted = {"kind": self.kind, "cell": self.cell, "share": self.share, "seed": self.seed}
        kinds = {"kind": "name", "cell": "size", "share": "share", "seed": "count"}
        off = [k for k, match in wanted.items() if match is not None and not matches(match, seen[k], kinds[k])]  # type: ignore[arg-type]
        expected = ", ".join(f"{key} {match.words()}" for key, match in wanted.items() if match is not None)
        observed = ", ".join(f"{key} {show(seen[key])}" for key, match in wanted.items() if match is not None)
        return Observation(not off, expected, observed, "world.obstacle_map" if off else None)
