"""``plan``: what is solid in the world agrees with a drawing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import shapely

from irsim_evals.grader.matching import Quantity, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene

_MIN_AREA = 1e-4
"""Differences of a smaller area come from rounding [m²]."""


@register("plan")
class Plan(ScenePredicate):
    """Everything solid in the world lies where a drawing has it, and nowhere else, up to a tolerance of the outlines.
    It does not matter whether it is made of walls, of one body or of a map, or whether the world has walls round it."""

    stage = "relations"

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
    """Greatest distance between an outline and that of the drawing [m]."""

    def observe(self, material: Material, scene: Scene) -> Observation:
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
        return Observation(
            bool(wanted.area) and not missing and not surplus,
            expected,
            "; ".join(filter(None, words)) or "as in the drawing",
            marks=marks,
        )

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
