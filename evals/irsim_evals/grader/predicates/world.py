"""The world: its properties, its map, everything solid in it, and how it differs from seed to seed."""

from __future__ import annotations

import itertools
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import shapely
from pydantic import model_validator

from irsim.diagnostics.errors import PlacementError
from irsim.objects.describe import grid_values
from irsim.options.registry import MAPS
from irsim.scenario.model.lookup import literals
from irsim.scenario.model.world import WorldModel
from irsim_evals.grader.matching import Counted, Kind, Match, Quantity, Seeds, checked, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, OfBodies, ScenePredicate, SeedsPredicate, register
from irsim_evals.grader.sanity import overlaps
from irsim_evals.grader.scene import open_scene
from irsim_evals.grader.words import OneOf

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import GradedScene

WORLD_KINDS: dict[str, Kind] = {
    "width": "length", "height": "length", "left": "length", "bottom": "length", "right": "length", "top": "length",
    "step_time": "time", "sample_time": "time", "time_limit": "time", "control_mode": "name", "collision_mode": "name",
    "step_mode": "name", "boundary": "name", "seed": "count", "fog_map": "flag", "fog_map_resolution": "size",
    "map": "name", "map_file": "name", "map_cell": "size", "map_share": "share", "map_seed": "count",
}  # fmt: skip
"""Property of the world → what it measures."""
_CHOICES = ("control_mode", "collision_mode", "step_mode", "boundary")
_WORDS = {"map": MAPS.installed()} | {name: literals(WorldModel.model_fields[name]) for name in _CHOICES}
"""Property of the world → words that it can be."""
WorldProperty = Annotated[str, OneOf("property of the world", tuple(WORLD_KINDS))]
_EDGES = ("left", "bottom", "right", "top")
_KEYS = {"left": "offset", "bottom": "offset", "right": "width", "top": "height"} | dict.fromkeys(
    ("map", "map_file", "map_cell", "map_share", "map_seed"), "obstacle_map"
)
_MIN_AREA = 1e-4
"""Differences of a smaller area come from rounding [m²]."""

_SAME = 1e-9
"""Distance [m] between two places that counts as none."""


@register("world")
class World(ScenePredicate):
    """The world has some properties: ``width``, ``top``, ``map`` (``image``, ``ros``, ``perlin``), … ``map_file``
    is the path of its picture as written, ``map_cell`` the longer side of its cells [m], ``map_share`` the share of
    them that is occupied, ``map_seed`` the seed of the map itself."""

    has: Annotated[dict[WorldProperty, Match], checked(WORLD_KINDS, _WORDS)]
    """Property → accepted values."""

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> Any:
        """The properties may be written without ``has``."""
        schema = handler.resolve_ref_schema(handler(core_schema))
        return {**schema["properties"]["has"], "description": schema.get("description", "")}

    @model_validator(mode="before")
    @classmethod
    def _short(cls, value: Any) -> Any:
        return value if isinstance(value, dict) and set(value) == {"has"} else {"has": value}

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Compare them."""
        values = {name: world_value(scene, name) for name in self.has}
        off = [name for name, match in self.has.items() if not matches(match, values[name], WORLD_KINDS[name])]
        expected = ", ".join(f"{name} {match.words()}" for name, match in self.has.items())
        observed = ", ".join(f"{name} {show(value)}" for name, value in values.items())
        return Observation(not off, expected, observed, f"world.{_KEYS.get(off[0], off[0])}" if off else None)


def world_value(scene: GradedScene, name: str) -> Any:
    """The value of a property of the world."""
    world = scene.world
    if name in _EDGES:
        return scene.bounds[_EDGES.index(name)]
    if name in ("map", "map_file"):
        given = getattr(world.obstacle_map, "path" if name == "map_file" else "name", None)
        return PurePosixPath(given).as_posix() if name == "map_file" and given is not None else given
    if name == "map_cell":
        return None if scene.env.scenario.grid is None else max(scene.env.scenario.grid.cell)
    if name == "map_share":
        return _occupied_share(scene)
    if name == "map_seed":
        return getattr(world.obstacle_map, "seed", None)
    return getattr(world, name)


def _occupied_share(scene: GradedScene) -> float | None:
    """Share of the cells of the map that are occupied; None without a map."""
    grid = scene.env.scenario.grid
    if grid is None:
        return None
    if grid.occupied >= 0:
        return float(grid.occupied / (grid.size[0] * grid.size[1]))
    return float(np.mean(np.asarray(grid_values(scene.env.simulation)) > 50))  # drawn anew for each scene


@register("plan", "relations")
class Plan(ScenePredicate):
    """Everything solid in the world lies where a drawing has it, and nowhere else, up to a tolerance of the outlines.
    It does not matter whether it is made of walls, of one body or of a map, or whether the world has walls round it."""

    sketch: str = ""
    """A drawing in characters; the first line is the top."""
    solid: str = "#"
    """Characters of the sketch that stand for solid cells."""
    cell: tuple[Quantity, Quantity] = (1.0, 1.0)
    """Width and height of a cell of the sketch [m]."""
    origin: tuple[Quantity, Quantity] = (0.0, 0.0)
    """Lower left corner of the sketch [m]."""
    boxes: list[tuple[Quantity, Quantity, Quantity, Quantity]] = []
    """Further solid rectangles: x0, y0, x1, y1 [m]."""
    discs: list[tuple[Quantity, Quantity, Quantity]] = []
    """Further solid discs: x, y, radius [m]."""
    ignore: list[tuple[Quantity, Quantity, Quantity, Quantity]] = []
    """Rectangles in which nothing is compared [m]."""
    tol: Quantity = 0.1
    """Greatest distance between an outline and the drawn one [m]."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Compare the areas."""
        wanted = self._wanted()
        expected = f"solid as in the drawing ({show(float(wanted.area))} m²), outlines within {show(self.tol)} m"
        apart = shapely.union_all([shapely.box(*corners) for corners in self.ignore])
        missing = _parts(shapely.difference(wanted, shapely.buffer(scene.solid, self.tol)), apart)
        rim = shapely.box(*scene.bounds).exterior.buffer(self.tol)  # the world may have walls round it
        surplus = _parts(shapely.difference(scene.solid, shapely.union(shapely.buffer(wanted, self.tol), rim)), apart)
        words = [_words("missing", missing), _words("too much", surplus)]
        marks = [Mark(points=[_middle(part)], text="missing") for part in missing[:5]]
        marks += [Mark(points=[_middle(part)], text="too much") for part in surplus[:5]]
        passed = bool(wanted.area) and not missing and not surplus
        return Observation(passed, expected, "; ".join(filter(None, words)) or "as in the drawing", marks=marks)

    def _wanted(self) -> Any:
        """Everything solid in the drawing."""
        lines = self.sketch.strip("\n").splitlines()
        (width, height), (left, bottom) = self.cell, self.origin
        cells = [
            shapely.box(left + k * width, bottom + row * height, left + (k + 1) * width, bottom + (row + 1) * height)
            for row, line in enumerate(reversed(lines))
            for k, letter in enumerate(line)
            if letter in self.solid
        ]
        boxes = [shapely.box(*corners) for corners in self.boxes]
        discs = [shapely.Point(x, y).buffer(radius, quad_segs=32) for x, y, radius in self.discs]
        return shapely.union_all([*cells, *boxes, *discs])


def _parts(geometry: Any, apart: Any) -> list[Any]:
    """The parts of a geometry outside of another, the largest first; lines without a width count, too."""
    left = shapely.difference(geometry, apart)
    parts = [part for part in shapely.get_parts(left) if not part.is_empty]
    large = [part for part in parts if part.area > _MIN_AREA or (part.area == 0 and part.length > _MIN_AREA)]
    return sorted(large, key=lambda part: (-part.area, -part.length))


def _middle(part: Any) -> list[float]:
    point = part.representative_point()
    return [float(point.x), float(point.y)]


def _words(what: str, parts: list[Any]) -> str:
    if not parts:
        return ""
    (x, y), area = _middle(parts[0]), sum(part.area for part in parts)
    return f"{what}: {show(float(area))} m², for example at ({x:.2f}, {y:.2f})"


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
