"""Where everything stands at the start: of the one scene there is, or of several that are drawn."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

import irsim._core as core
from irsim.components.maps._grid import MapCells, MapGrid, Walls
from irsim.components.maps._site import Raster
from irsim.scenario.checks import Context
from irsim.scenario.resolve.body_size import has_fixed_shape, parts_of
from irsim.scenario.resolve.resolved import ObjectRecord
from irsim.simulation.build import build_world

__all__ = ["FAR", "Drawn", "Scene", "scenes_of"]

FAR = (-1e8, -1e8, 1e8, 1e8)
"""Bounds of a terrain that nothing leaves."""
_SEEDS = 20
_MOST_PLACED = 6_000
"""Objects in all scenes together, unless that is less than two scenes."""
_MOST_TERRAINS = 5
_MAP_CELLS = 1_000_000
"""Scenes over maps with more cells are not drawn."""
_MOST_EDGES = 300_000
"""Maps whose outline has about so many more edges are left alone."""
_EVERY = 16

Thing = tuple[list[Any], list[float]]


@dataclass
class Scene:
    """One scene.

    Attributes:
        seed: Of what is drawn.
        pose: x, y, heading of each object, by id.
        goals: Goals of each object, by id.
        things: Parts and pose of what stands still and is in the way.
        bounds: The world's extent [m].
        rough: Fewer cells than usual are looked at.
        kept: What was found out about it.
    """

    seed: int
    pose: dict[int, list[float]]
    goals: dict[int, list[list[float]]]
    things: list[Thing]
    bounds: tuple[float, float, float, float]
    rough: bool = False
    kept: dict[str, Any] = field(default_factory=dict, repr=False)
    _same: Scene | None = field(default=None, repr=False)

    @cached_property
    def terrain(self) -> core.Terrain:
        """What is in the way."""
        return self._same.terrain if self._same is not None else core.Terrain(FAR, self.things)

    def shares_with(self, other: Scene) -> None:
        """The same things stand there."""
        self._same = other

    @property
    def owner(self) -> Scene:
        """The first of the scenes with the same things: what was found out about them is kept with it."""
        return self if self._same is None else self._same


@dataclass
class Drawn:
    """Scenes of a scenario.

    Attributes:
        scenes: Those in which everything found its place.
        random: Whether anything about them is drawn.
        tried: How many were drawn.
        failed: Seed → the object that found no room.
        own: The seed of the scenario itself, if it has one.
    """

    scenes: list[Scene]
    random: bool
    tried: int
    failed: dict[int, int]
    own: int | None


def scenes_of(context: Context) -> Drawn:
    """The scene of a scenario without chance; else those of its own seed and of the seeds from 0 on."""
    resolved, own = context.resolved, context.scenario.world.seed
    placed = bool(resolved.placements)
    free = [record for record in resolved.objects if not has_fixed_shape(record.shape)]
    if _is_intricate(resolved.grid):
        return Drawn([], random=False, tried=0, failed={}, own=own)
    if not placed and not free:
        return Drawn([_written(context)], random=False, tried=1, failed={}, own=own)
    if resolved.grid is not None and resolved.grid.size[0] * resolved.grid.size[1] > _MAP_CELLS:
        return Drawn([], random=True, tried=0, failed={}, own=own)
    randomly = {index for placement in resolved.placements for index in placement.objects}
    still_random = any(_in_the_way(r) and (r.id in randomly or not has_fixed_shape(r.shape)) for r in resolved.objects)
    count = max(2, min(_SEEDS, _MOST_PLACED // max(1, len(resolved.objects))))
    seeds = list(dict.fromkeys([*([own] if own is not None else []), *range(count)]))[:count]
    world, state = _built(context, seeds)
    failed = {seed: int(state.failed_placement[w]) for w, seed in enumerate(seeds) if state.failed_placement[w] >= 0}
    good = [w for w, seed in enumerate(seeds) if seed not in failed]
    scenes: list[Scene] = []
    for w in good[:_MOST_TERRAINS] if still_random else good:
        things = scenes[0].things if scenes and not still_random else _things(context, world, state, w)
        scenes.append(_drawn(context, world, state, w, seeds[w], things))
        scenes[-1].rough = still_random
        if len(scenes) > 1 and not still_random:
            scenes[-1].shares_with(scenes[0])
    return Drawn(scenes, random=True, tried=len(seeds), failed=failed, own=own)


def _is_intricate(grid: MapGrid | None) -> bool:
    """Whether the outline of a map is very long, judged by some of its columns."""
    if grid is None or grid.raster is None or grid.size[0] * grid.size[1] <= _MAP_CELLS:
        return False
    some = Raster(grid.raster.levels[::_EVERY], grid.raster.table).occupied()
    return _EVERY * int(np.count_nonzero(some[:, 1:] != some[:, :-1])) > _MOST_EDGES


def _in_the_way(record: ObjectRecord) -> bool:
    return record.static and not record.unobstructed


def _written(context: Context) -> Scene:
    """The scene as it is written."""
    records = context.resolved.objects
    known: dict[int, list[Any]] = {}
    things: list[Thing] = []
    for record in records:
        if _in_the_way(record):
            key = id(record.shape)
            if key not in known:
                known[key] = parts_of(record.shape)
            things.append((known[key], record.state[:3]))
    return Scene(
        seed=context.scenario.world.seed or 0,
        pose={record.id: record.state[:3] for record in records},
        goals={record.id: record.goals for record in records},
        things=things,
        bounds=context.scenario.world.bounds,
    )


def _built(context: Context, seeds: list[int]) -> tuple[core.World, core.State]:
    """The core's own placement, for objects that neither think nor look."""
    bare = [
        replace(record, sensors=[], behavior=None, group_behavior=None)
        if record.sensors or record.kinematics
        else record
        for record in context.resolved.objects
    ]
    world = context.resolved.world.model_copy(update={"fog_map": False, "collision_mode": "unobstructed"})
    built = build_world(replace(context.resolved, objects=bare, world=world), len(seeds))
    return built, core.State(built, np.array(seeds, dtype=np.uint64), False)


def _drawn(context: Context, world: core.World, state: core.State, w: int, seed: int, things: list[Thing]) -> Scene:
    first = w * world.objects
    records = context.resolved.objects
    return Scene(
        seed=seed,
        pose={record.id: state.pose[first + k].tolist() for k, record in enumerate(records)},
        goals={record.id: state.goals(first + k) for k, record in enumerate(records)},
        things=things,
        bounds=context.scenario.world.bounds,
    )


def _things(context: Context, world: core.World, state: core.State, w: int) -> list[Thing]:
    """What stands in the way in world ``w``, drawn shapes as they were drawn."""
    things: list[Thing] = []
    for k, record in enumerate(context.resolved.objects):
        row = w * world.objects + k
        if not _in_the_way(record):
            continue
        if has_fixed_shape(record.shape):
            things.append((parts_of(record.shape), state.pose[row].tolist()))
        elif isinstance(record.shape, (MapCells, Walls)):
            cells = state.cells(row)
            things += [([core.GridCells(grid=cells)], [0.0, 0.0, 0.0])] if cells is not None else []
        else:
            things.append((_drawn_parts(state, row), [0.0, 0.0, 0.0]))
    return things


def _drawn_parts(state: core.State, row: int) -> list[Any]:
    """The body of a row, world frame."""
    parts: list[Any] = []
    for part, kind in enumerate(state.parts(row)):
        if kind == "circle":
            x, y, radius = state.circle(row, part, True)
            parts.append(core.Circle(radius=radius, center=[x, y]))
        else:
            make = core.Polygon if kind == "polygon" else core.Linestring
            parts.append(make(vertices=state.vertices(row, part, True).tolist()))
    return parts
