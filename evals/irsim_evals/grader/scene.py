"""One world of a scenario at its start: bodies, what is solid, and where robots can get to."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

import irsim._core as core
from irsim.common.outline import outline
from irsim.env import Env
from irsim.validation.feasibility.clearance_grid import cells_over
from irsim.validation.feasibility.scenes import FAR
from irsim_evals.grader.body import GradedBody, body_of

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["GradedScene", "open_scene"]

Point = tuple[float, float]
_MAX_CELLS = 150_000
"""Greatest number of cells of the grid on which paths are searched."""
_CELLS_PER_RADIUS = 5
"""Cells along the radius of the body whose path is searched, unless that takes too many cells."""
_HALF_DIAGONAL = math.sqrt(0.5)
"""Half the diagonal of a square cell of size 1."""


@dataclass
class GradedScene:
    """One world at its start.

    Attributes:
        seed: Its seed.
        env: The environment at its start.
        bodies: Robots and obstacles in the order of the file; neither the map nor the walls round the world.
        kept: Results that are asked for again.
    """

    seed: int
    env: Env
    bodies: list[GradedBody]
    kept: dict[Any, Any] = field(default_factory=dict, repr=False)

    @property
    def world(self) -> Any:
        """Options of the world."""
        return self.env.scenario.world

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """x0, y0, x1, y1 of the world [m]."""
        x0, y0, x1, y1 = self.world.bounds
        return float(x0), float(y0), float(x1), float(y1)

    @property
    def robots(self) -> list[GradedBody]:
        """Bodies with the role of a robot."""
        return [body for body in self.bodies if body.role == "robot"]

    @property
    def solids(self) -> list[GradedBody]:
        """Bodies that never move and that others cannot pass."""
        return [body for body in self.bodies if not body.passable and body.static]

    @cached_property
    def solid(self) -> Any:
        """Everything that never moves and cannot be passed, the map included, as one geometry."""
        footprints = [*(body.footprint for body in self.solids), self.terrain_area]
        return shapely.union_all(np.array(footprints, dtype=object))  # an empty list alone would be an error

    @cached_property
    def terrain_area(self) -> Any:
        """The occupied cells of the map, filled, and the lines of the walls round the world."""
        shapes = [
            view.geometry if view.shape == "walls" else shapely.build_area(view.geometry) for view in self.terrain_views
        ]
        return shapely.union_all(np.array(shapes, dtype=object))

    @cached_property
    def terrain_views(self) -> list[Any]:
        """The map and the walls round the world, unless others pass through them."""
        return [view for view in self._views if view.record.is_terrain and not view.record.unobstructed]

    @cached_property
    def _views(self) -> list[Any]:
        return sorted([*self.env.robot_list, *self.env.obstacle_list], key=lambda view: view.index)

    @cached_property
    def things(self) -> list[Any]:
        """Parts and pose of everything solid, as the core takes them."""
        poses = {body.index: list(body.pose) for body in self.solids}  # the simulation has none of what comes late
        simulation = self.env.simulation
        return [
            (outline(simulation.state, view.row).core(), poses.get(view.index, simulation.pose[view.row].tolist()))
            for view in self._views
            if view.index in poses or view in self.terrain_views
        ]

    @cached_property
    def terrain(self) -> core.Terrain:
        """Everything solid, for collision queries of the core."""
        return core.Terrain(FAR, self.things)

    def is_free(self, place: Point, radius: float) -> bool:
        """Whether a disc fits at a place."""
        return not self.terrain.collides([core.Circle(radius=radius, center=[0, 0])], (*place, 0.0))

    def path_width(self, start: Point, goal: Point, radius: float, plugs: tuple[tuple[float, ...], ...] = ()) -> float:
        """Clearance of the widest path inside the world from one place to another [m]; -infinity without a path.

        Args:
            start, goal: Both ends.
            radius: Radius for which the cells are fine enough.
            plugs: x, y, radius of discs that are put there first, to close gaps.
        """
        clearance, half = self._clearance(radius, plugs)
        width: float = clearance.widest(start, goal, 0.0)[0]
        return width + half  # infinite where nothing solid is in the way, minus infinite without a path

    def is_reachable(self, start: Point, goal: Point, radius: float, plugs: tuple[tuple[float, ...], ...] = ()) -> bool:
        """Whether a disc can get from one place to another inside the world."""
        return self.path_width(start, goal, radius, plugs) >= radius

    def _clearance(self, radius: float, plugs: tuple[tuple[float, ...], ...]) -> tuple[core.Clearance, float]:
        cells = cells_over(self.bounds, max(radius / _CELLS_PER_RADIUS, 1e-3), _MAX_CELLS)
        key = (cells, plugs)
        if key not in self.kept:
            discs = [([core.Circle(radius=r, center=[0, 0])], [x, y, 0.0]) for x, y, r in plugs]
            terrain = core.Terrain(FAR, [*self.things, *discs]) if discs else self.terrain
            self.kept[key] = core.Clearance(terrain, cells)
        return self.kept[key], _HALF_DIAGONAL * max(cells[1])


def open_scene(scenario: ResolvedScenario, seed: int) -> GradedScene:
    """Build one world of a scenario.

    Raises:
        PlacementError: A random object found no free place.
    """
    env = Env(scenario, seed=seed, display=False, headless=True, log_level="ERROR")
    views = sorted([*env.robot_list, *env.obstacle_list], key=lambda view: view.index)
    return GradedScene(seed, env, [body_of(view, env.scenario) for view in views if not view.record.is_terrain])
