"""Differences between seeds, and the share of seeds in which nothing overlaps."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.diagnostics.errors import PlacementError
from irsim_evals.grader.matching import Counted, Quantity, Seeds, show
from irsim_evals.grader.predicates._base import Observation, OfBodies, SeedsPredicate, register
from irsim_evals.grader.sanity import overlaps
from irsim_evals.grader.scene import open_scene

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import GradedScene

_SAME = 1e-9
"""Distance [m] between two places that counts as none."""


@register("varies", "relations")
class Varies(OfBodies, SeedsPredicate):
    """The bodies of a selection start elsewhere with each seed, and with the same seed where they did before."""

    seeds: Seeds = [0, 1, 2, 3, 4]
    """Seeds that are compared."""
    spread: Quantity = 0.0
    """Least standard deviation of each coordinate over bodies and seeds [m]."""
    resets: bool = False
    """Also compare what ``reset(random=True)`` draws."""
    goals: bool = True
    """Goals must differ, too."""

    def observe(self, material: Material) -> Observation:
        """Build the worlds."""
        expected = f"{self.of} start elsewhere with each seed"
        places = [self._places(material, material.scene(seed)) for seed in self.seeds]
        if not places[0].size:
            return Observation(False, expected, f"{self.of}: no body")
        if any(p.shape != places[0].shape for p in places):
            return Observation(False, expected, "another number with another seed")
        for k, (a, b) in enumerate(itertools.pairwise(places)):
            if _fixed(a, b):
                return Observation(
                    False, expected, f"the same place with the seeds {self.seeds[k]} and {self.seeds[k + 1]}"
                )
        if material.scenario is not None:
            again = self._places(material, open_scene(material.scenario, self.seeds[0]))
            if np.abs(again - places[0]).max() > _SAME:
                return Observation(False, expected, f"other places with the same seed {self.seeds[0]}")
            if self.resets:
                scene = open_scene(material.scenario, self.seeds[0])
                scene.env.reset(random=True)
                indices = [body.index for body in material.bodies(material.scene(self.seeds[0]), self.of)]
                if np.abs(scene.env.simulation.pose[indices, :2] - places[0][:, :2]).max() <= _SAME:
                    return Observation(False, expected, "the same places after reset(random=True)")
        spread = np.concatenate(places)[:, :2].std(axis=0)
        if spread.min() < self.spread:
            return Observation(False, f"{expected}, spread by {show(self.spread)} m", f"{show(float(spread.min()))} m")
        return Observation(True, expected, f"{len(self.seeds)} seeds differ")

    def _places(self, material: Material, scene: GradedScene) -> Any:
        rows = []
        for body in material.bodies(scene, self.of):
            goal = body.goal[:2] if self.goals and body.goal is not None else []
            rows.append([*body.position, *goal])
        return np.array(rows, dtype=float)


def _fixed(a: Any, b: Any) -> bool:
    """Whether some start, or all goals, stay where they were."""
    starts = np.abs(a[:, :2] - b[:, :2]).max(axis=1)
    goals = np.abs(a[:, 2:] - b[:, 2:])
    return bool(starts.min() <= _SAME or (goals.size and goals.max(axis=1).min() <= _SAME))


@register("overlap_free", "sane")
class OverlapFree(SeedsPredicate):
    """Nothing overlaps at the start in a share of the seeds; a seed without a free place counts as an overlap."""

    seeds: Counted = 20
    """Number of seeds, from 0 on."""
    share: Quantity
    """Least share of them."""

    def observe(self, material: Material) -> Observation:
        """Count the seeds."""
        bad = []
        for seed in range(self.seeds):
            try:
                if overlaps(material, material.scene(seed)):
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
