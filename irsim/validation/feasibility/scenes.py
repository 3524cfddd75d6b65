"""Initial poses, goals and obstacles of a scenario: one scene, or several with different seeds if some are random."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

import irsim._core as core
from irsim.common.outline import outline
from irsim.components.maps._grid import MapCells, MapGrid, Walls
from irsim.components.maps._site import Raster
from irsim.scenario.checks import Context
from irsim.scenario.checks.overlap import FAR
from irsim.scenario.resolve.body_size import has_fixed_shape
from irsim.scenario.resolve.kernels import parts_of
from irsim.scenario.resolve.resolved import ObjectRecord
from irsim.simulation.build import build_world

__all__ = ["FAR", "Drawn", "StartState", "scenes_of"]

_MAX_SEEDS = 20
"""Number of seeds that are tried."""
_MAX_PLACED_OBJECTS = 6_000
"""Number of objects in all scenes together, though at least two scenes are drawn."""
_MAX_TERRAINS = 5
"""Number of scenes that are examined if their obstacles differ."""
_MAX_MAP_CELLS = 1_000_000
"""Random scenes over maps with more cells are not examined."""
_MAX_MAP_EDGES = 300_000
"""Maps whose outline has more edges are not examined."""
_COLUMN_STRIDE = 16
"""Distance, in columns, between the columns of a large map from which the length of its outline is estimated."""

Thing = tuple[list[Any], list[float]]


@dataclass
class StartState:
    """The initial state of a world.

    Attributes:
        seed: Seed of the random poses, goals and shapes.
        pose: x, y, heading of each object, by id [m, m, rad].
        goals: Goals of each object, by id.
        things: Parts and pose of each static obstacle.
        bounds: Extent of the world: left, bottom, right, top [m].
        rough: Whether coarser grids are used, because several scenes are examined.
        kept: Results computed for the scene, by key.
    """

    seed: int
    pose: dict[int, list[float]]
    goals: dict[int, list[list[float]]]
    things: list[Thing]
    bounds: tuple[float, float, float, float]
    rough: bool = False
    kept: dict[str, Any] = field(default_factory=dict, repr=False)
    _same: StartState | None = field(default=None, repr=False)

    @cached_property
    def terrain(self) -> core.Terrain:
        """The static obstacles, ready for collision queries."""
        return self._same.terrain if self._same is not None else core.Terrain(FAR, self.things)

    def shares_with(self, other: StartState) -> None:
        """Declare that another scene has the same static obstacles, so that both use its results."""
        self._same = other

    @property
    def owner(self) -> StartState:
        """The scene that keeps the results for all scenes with the same static obstacles."""
        return self if self._same is None else self._same


@dataclass
class Drawn:
    """Scenes of a scenario.

    Attributes:
        scenes: Scenes in which every object found a free place.
        random: Whether the scenes are random.
        tried: Number of seeds that were tried.
        failed: Seed → index of the object that found no free place.
        own: The seed of the scenario itself, if it has one.
    """

    scenes: list[StartState]
    random: bool
    tried: int
    failed: dict[int, int]
    own: int | None


def scenes_of(context: Context) -> Drawn:
    """The one scene of a scenario without randomness; else the scenes of its own seed and of the seeds from 0 on."""
    resolved, own = context.resolved, context.scenario.world.seed
    placed = bool(resolved.placements)
    free = [record for record in resolved.objects if not has_fixed_shape(record.shape)]
    if _is_intricate(resolved.grid):
        return Drawn([], random=False, tried=0, failed={}, own=own)
    if not placed and not free:
        return Drawn([_fixed_scene(context)], random=False, tried=1, failed={}, own=own)
    if resolved.grid is not None and resolved.grid.size[0] * resolved.grid.size[1] > _MAX_MAP_CELLS:
        return Drawn([], random=True, tried=0, failed={}, own=own)
    randomly = {index for placement in resolved.placements for index in placement.objects}
    random_things = any(
        _is_obstacle(r) and (r.id in randomly or not has_fixed_shape(r.shape)) for r in resolved.objects
    )
    count = max(2, min(_MAX_SEEDS, _MAX_PLACED_OBJECTS // max(1, len(resolved.objects))))
    seeds = list(dict.fromkeys([*([own] if own is not None else []), *range(count)]))[:count]
    world, state = _build_worlds(context, seeds)
    failed = {seed: int(state.failed_placement[w]) for w, seed in enumerate(seeds) if state.failed_placement[w] >= 0}
    good = [w for w, seed in enumerate(seeds) if seed not in failed]
    scenes: list[StartState] = []
    for w in good[:_MAX_TERRAINS] if random_things else good:
        things = scenes[0].things if scenes and not random_things else _things(context, world, state, w)
        scenes.append(_scene_of_world(context, world, state, w, seeds[w], things))
        scenes[-1].rough = random_things
        if len(scenes) > 1 and not random_things:
            scenes[-1].shares_with(scenes[0])
    return Drawn(scenes, random=True, tried=len(seeds), failed=failed, own=own)


def _is_intricate(grid: MapGrid | None) -> bool:
    """Whether the outline of a map is very long, estimated from some of its columns."""
    if grid is None or grid.raster is None or grid.size[0] * grid.size[1] <= _MAX_MAP_CELLS:
        return False
    some = Raster(grid.raster.levels[::_COLUMN_STRIDE], grid.raster.table).occupied()
    return _COLUMN_STRIDE * int(np.count_nonzero(some[:, 1:] != some[:, :-1])) > _MAX_MAP_EDGES


def _is_obstacle(record: ObjectRecord) -> bool:
    return record.static and not record.unobstructed


def _fixed_scene(context: Context) -> StartState:
    """The scene of a scenario in which nothing is random."""
    records = context.resolved.objects
    known: dict[int, list[Any]] = {}
    things: list[Thing] = []
    for record in records:
        if _is_obstacle(record):
            key = id(record.shape)
            if key not in known:
                known[key] = parts_of(record.shape)
            things.append((known[key], record.state[:3]))
    return StartState(
        seed=context.scenario.world.seed or 0,
        pose={record.id: record.state[:3] for record in records},
        goals={record.id: record.goals for record in records},
        things=things,
        bounds=context.scenario.world.bounds,
    )


def _build_worlds(context: Context, seeds: list[int]) -> tuple[core.World, core.State]:
    """One world per seed, placed by the core, whose objects have no behavior and no sensors."""
    bare = [
        record.with_sensors([], behavior=None, group_behavior=None, appear_time=0.0)
        if record.sensors or record.kinematics or record.appear_time
        else record
        for record in context.resolved.objects
    ]
    world = context.resolved.world.model_copy(update={"fog_map": False, "collision_mode": "unobstructed"})
    built = build_world(replace(context.resolved, objects=bare, world=world), len(seeds))
    return built, core.State(built, np.array(seeds, dtype=np.uint64), False)


def _scene_of_world(
    context: Context, world: core.World, state: core.State, w: int, seed: int, things: list[Thing]
) -> StartState:
    first = w * world.objects
    records = context.resolved.objects
    return StartState(
        seed=seed,
        pose={record.id: state.pose[first + k].tolist() for k, record in enumerate(records)},
        goals={record.id: state.goals(first + k) for k, record in enumerate(records)},
        things=things,
        bounds=context.scenario.world.bounds,
    )


def _things(context: Context, world: core.World, state: core.State, w: int) -> list[Thing]:
    """The static obstacles in world ``w``, with random shapes as drawn."""
    things: list[Thing] = []
    for k, record in enumerate(context.resolved.objects):
        row = w * world.objects + k
        if not _is_obstacle(record):
            continue
        if has_fixed_shape(record.shape):
            things.append((parts_of(record.shape), state.pose[row].tolist()))
        elif isinstance(record.shape, (MapCells, Walls)):
            cells = state.cells(row)
            things += [([core.GridCells(grid=cells)], [0.0, 0.0, 0.0])] if cells is not None else []
        else:
            things.append((outline(state, row, world_frame=True).core(), [0.0, 0.0, 0.0]))
    return things
